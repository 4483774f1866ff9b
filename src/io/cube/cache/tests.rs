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
