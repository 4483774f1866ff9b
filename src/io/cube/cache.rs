//! A cache of recently read values, under many locks, with one total limit.
//!
//! Each shard evicts by the clock algorithm: a hand goes round, and evicts what was not used since its last pass. Shards may grow
//! unevenly while there is room; once there is none, a shard with more than its share makes room for one with less.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Values by number.
#[derive(Debug)]
pub(super) struct Cache<V> {
    shards: Box<[Mutex<Shard<V>>]>,
    /// The largest number of values that are kept; at least one per shard.
    room: usize,
    count: AtomicUsize,
}

/// A part of the values, locked.
pub(super) struct Locked<'a, V> {
    cache: &'a Cache<V>,
    number: usize,
    shard: MutexGuard<'a, Shard<V>>,
}

#[derive(Debug)]
struct Shard<V> {
    places: HashMap<u64, usize, BuildHasherDefault<KeyHasher>>,
    slots: Vec<Slot<V>>,
    /// The next slot to evict.
    hand: usize,
}

#[derive(Debug)]
struct Slot<V> {
    key: u64,
    value: V,
    /// Whether it was used since the hand last passed.
    used: bool,
}

/// A fast hash of a number; no adversary chooses the keys.
#[derive(Debug, Default)]
struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    #[inline]
    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 32);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

impl<V: Clone> Cache<V> {
    /// With room for `room` values under `shards` locks.
    pub fn new(room: usize, shards: usize) -> Cache<V> {
        let shard = || {
            Mutex::new(Shard {
                places: HashMap::default(),
                slots: Vec::new(),
                hand: 0,
            })
        };
        Cache {
            shards: (0..shards).map(|_| shard()).collect(),
            room,
            count: AtomicUsize::new(0),
        }
    }

    /// Locks the values of a group of keys.
    pub fn lock(&self, group: u64) -> Locked<'_, V> {
        // Groups that differ by a power of two must not all share a lock.
        let mixed = group.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let number = mixed as usize % self.shards.len();
        let shard = &self.shards[number];
        Locked {
            cache: self,
            number,
            shard: locked(shard),
        }
    }
}

impl<V: Clone> Locked<'_, V> {
    pub fn get(&mut self, key: u64) -> Option<V> {
        let place = *self.shard.places.get(&key)?;
        let slot = &mut self.shard.slots[place];
        slot.used = true;
        Some(slot.value.clone())
    }

    /// Inserts a value that is not in the cache; returns the evicted one, if there is no more room.
    pub fn insert(&mut self, key: u64, value: V) -> Option<V> {
        let Cache {
            shards,
            room,
            count,
        } = self.cache;
        let mut evicted = None;
        if count.fetch_add(1, Ordering::Relaxed) >= *room {
            let part = room / shards.len();
            if self.shard.slots.len() <= part {
                evicted = self.takes_from_others(part);
            }
            if evicted.is_none() && !self.shard.slots.is_empty() {
                evicted = Some(self.shard.evict());
            }
            if evicted.is_some() {
                count.fetch_sub(1, Ordering::Relaxed);
            }
        }
        let place = self.shard.slots.len();
        self.shard.places.insert(key, place);
        self.shard.slots.push(Slot {
            key,
            value,
            used: true,
        });
        evicted
    }

    /// A value evicted from a shard with more than its share, if there is one. Locked shards are skipped.
    fn takes_from_others(&self, part: usize) -> Option<V> {
        let shards = &self.cache.shards;
        let others = (1..shards.len()).map(|k| &shards[(self.number + k) % shards.len()]);
        for other in others {
            if let Ok(mut other) = other.try_lock()
                && other.slots.len() > part
            {
                return Some(other.evict());
            }
        }
        None
    }
}

impl<V> Shard<V> {
    /// Evicts a value that has gone unused for about the longest time; there is at least one.
    fn evict(&mut self) -> V {
        self.hand %= self.slots.len();
        while std::mem::take(&mut self.slots[self.hand].used) {
            self.hand = (self.hand + 1) % self.slots.len();
        }
        let slot = self.slots.swap_remove(self.hand);
        self.places.remove(&slot.key);
        // The last slot has moved into the gap.
        if let Some(moved) = self.slots.get(self.hand) {
            self.places.insert(moved.key, self.hand);
        }
        self.hand += 1;
        slot.value
    }
}

/// Locks; the state left by a panicked thread is still valid.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn all_is_kept_while_there_is_room_however_it_lies() {
        let cache = Cache::new(100, 8);
        // All in one group, so under one lock.
        for key in 0..100 {
            cache.lock(3).insert(key, key);
        }
        assert!((0..100).all(|key| cache.lock(3).get(key) == Some(key)));
    }

    #[test]
    fn what_was_not_used_makes_way_and_no_more_is_kept_than_there_is_room() {
        let cache = Cache::new(100, 8);
        let mut given_out = HashSet::new();
        for key in 0..10_000u64 {
            let group = key % 50;
            if cache.lock(0).get(0).is_none() {
                cache.lock(0).insert(0, 7);
            }
            if key > 0 {
                let mut locked = cache.lock(group);
                assert_eq!(locked.get(key), None);
                let made_way = locked.insert(key, key);
                assert_eq!(locked.get(key), Some(key));
                // Evicted values are returned only once; 7 is also the value of key 0.
                if let Some(old) = made_way.filter(|old| *old != 7) {
                    assert!(old < key && given_out.insert(old), "{old} for {key}");
                }
            }
        }
        let slots = |shard: &Mutex<Shard<u64>>| shard.lock().unwrap().slots.len();
        let kept: usize = cache.shards.iter().map(slots).sum();
        assert_eq!(kept, cache.count.load(Ordering::Relaxed));
        assert!((90..=108).contains(&kept), "{kept}");
        // The positions match the slots, and values in constant use have stayed.
        for shard in &cache.shards {
            let shard = shard.lock().unwrap();
            assert_eq!(shard.places.len(), shard.slots.len());
            for (place, slot) in shard.slots.iter().enumerate() {
                assert_eq!(shard.places[&slot.key], place);
            }
        }
        assert_eq!(cache.lock(0).get(0), Some(7));
    }

    #[test]
    fn threads_share_it() {
        let cache = Cache::new(64, 4);
        std::thread::scope(|scope| {
            for thread in 0..4u64 {
                let cache = &cache;
                scope.spawn(move || {
                    for n in 0..20_000u64 {
                        let key = (n * 7 + thread * 13) % 500;
                        let mut locked = cache.lock(key % 20);
                        match locked.get(key) {
                            Some(value) => assert_eq!(value, key),
                            None => {
                                locked.insert(key, key);
                            }
                        }
                    }
                });
            }
        });
        let slots = |shard: &Mutex<Shard<u64>>| shard.lock().unwrap().slots.len();
        assert!(cache.shards.iter().map(slots).sum::<usize>() <= 64 + 4 + 4);
    }
}
