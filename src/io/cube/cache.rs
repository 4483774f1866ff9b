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
mod tests;
