//! Equal keys under one number, counted in the order in which they first appear.
//!
//! - Cost: O(n) by hashing; O(n log n) by sorting where keys were chosen to collide, so that no file
//!   takes long on purpose.

use dgp_mesh::{Cancelled, Progress};

use crate::pulse::Pulse;

/// How many slots an item may cost on average before the keys count as chosen to collide.
const PROBES: usize = 64;

/// What items are compared by.
pub(crate) trait Key: Copy + Ord {
    /// A number that every bit of the key reaches.
    fn hash(self) -> u64;
}

impl Key for [u64; 3] {
    #[inline]
    fn hash(self) -> u64 {
        self.iter().fold(SEED, |state, &word| mixed(state ^ word))
    }
}

impl Key for [u32; 3] {
    #[inline]
    fn hash(self) -> u64 {
        let [x, y, z] = self.map(u64::from);
        mixed(mixed(SEED ^ (x << 32 | y)) ^ z)
    }
}

// Odd constants without structure: digits of π.
const SEED: u64 = 0x243f_6a88_85a3_08d3;

/// Both halves of a 128-bit product.
#[inline]
fn mixed(word: u64) -> u64 {
    let product = u128::from(word) * 0xa409_3822_299f_31d1_u128;
    (product as u64) ^ ((product >> 64) as u64)
}

/// Which items are equal.
#[derive(Debug, PartialEq)]
pub(crate) struct Welded<K> {
    /// The number of each item.
    pub(crate) numbers: Vec<u32>,
    /// The key of each number.
    pub(crate) keys: Vec<K>,
    /// The first item of each number.
    pub(crate) firsts: Vec<u32>,
}

/// Numbers `len` items so that those with equal keys share a number.
pub(crate) fn weld<K: Key>(
    len: usize,
    key: impl Fn(usize) -> K,
    progress: Progress<'_>,
) -> Result<Welded<K>, Cancelled> {
    let pulse = Pulse::new(len, progress);
    let welded = hashed(len, &key, &pulse);
    pulse.end()?;
    Ok(welded.unwrap_or_else(|| sorted(len, &key)))
}

/// Items whose slots are looked up together: so many misses of the cache go on side by side.
const BATCH: usize = 32;

/// The numbers by a hash table, or `None` if far too many keys collide.
fn hashed<K: Key>(len: usize, key: impl Fn(usize) -> K, pulse: &Pulse<'_>) -> Option<Welded<K>> {
    // A closed triangle mesh has six corners a vertex: two slots an expected vertex.
    let mut table = Table {
        slots: vec![0; (len / 3).next_power_of_two().max(2 * BATCH)],
        keys: Vec::new(),
        firsts: Vec::new(),
        probes: PROBES * len + 4096,
    };
    let mut numbers = Vec::with_capacity(len);
    for first in (0..len).step_by(BATCH).take_while(|&first| pulse.beat(first)) {
        // Numbers that slots hold stay until the table grows, which it does between batches.
        if 2 * (table.keys.len() + BATCH) > table.slots.len() {
            table.grow()?;
        }
        let mut batch = [None; BATCH];
        for (i, place) in (first..len).zip(&mut batch) {
            let key = key(i);
            let slot = key.hash() as usize & (table.slots.len() - 1);
            *place = Some((key, slot, table.slots[slot]));
        }
        for (i, (key, slot, number)) in (first..).zip(batch.into_iter().flatten()) {
            numbers.push(match number {
                1.. if table.keys[number as usize - 1] == key => number - 1,
                _ => table.number(key, slot, i)?,
            });
        }
    }
    Some(Welded { numbers, keys: table.keys, firsts: table.firsts })
}

/// Open addressing, at most half full; a slot holds a number plus 1.
struct Table<K> {
    slots: Vec<u32>,
    keys: Vec<K>,
    firsts: Vec<u32>,
    /// How many more slots may be looked at in vain.
    probes: usize,
}

impl<K: Key> Table<K> {
    /// The number of the key of item `i`, which is in `slot` or behind it if it is known.
    fn number(&mut self, key: K, mut slot: usize, i: usize) -> Option<u32> {
        loop {
            match self.slots[slot] {
                0 => break,
                taken if self.keys[taken as usize - 1] == key => return Some(taken - 1),
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
            self.probes = self.probes.checked_sub(1)?;
        }
        self.keys.push(key);
        self.firsts.push(i as u32);
        self.slots[slot] = self.keys.len() as u32;
        Some(self.keys.len() as u32 - 1)
    }

    fn grow(&mut self) -> Option<()> {
        let len = 4 * self.slots.len();
        self.slots.clear();
        self.slots.resize(len, 0);
        for (number, key) in self.keys.iter().enumerate() {
            let mut slot = key.hash() as usize & (len - 1);
            while self.slots[slot] != 0 {
                self.probes = self.probes.checked_sub(1)?;
                slot = (slot + 1) & (len - 1);
            }
            self.slots[slot] = number as u32 + 1;
        }
        Some(())
    }
}

/// The same numbers by sorting, for keys that defeat the hash.
fn sorted<K: Key>(len: usize, key: impl Fn(usize) -> K) -> Welded<K> {
    let mut order: Vec<u32> = (0..len as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i as usize), i));
    let mut first = vec![0; len];
    for group in order.chunk_by(|&i, &j| key(i as usize) == key(j as usize)) {
        for &i in group {
            first[i as usize] = group[0];
        }
    }
    let mut welded = Welded { numbers: Vec::with_capacity(len), keys: vec![], firsts: vec![] };
    for (i, &first) in first.iter().enumerate() {
        let number = if first as usize == i {
            welded.keys.push(key(i));
            welded.firsts.push(first);
            welded.keys.len() as u32 - 1
        } else {
            welded.numbers[first as usize]
        };
        welded.numbers.push(number);
    }
    welded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn welded<K: Key>(len: usize, key: impl Fn(usize) -> K) -> Welded<K> {
        weld(len, key, Progress::NONE).unwrap()
    }

    fn hashed<K: Key>(len: usize, key: impl Fn(usize) -> K) -> Option<Welded<K>> {
        super::hashed(len, key, &Pulse::new(len, Progress::NONE))
    }

    #[test]
    fn numbers_follow_first_appearance() {
        let keys = [7, 3, 7, 9, 3].map(|x| [x, 0, 1_u64]);
        let welded = welded(keys.len(), |i| keys[i]);
        assert_eq!(welded.numbers, [0, 1, 0, 2, 1]);
        assert_eq!(welded.firsts, [0, 1, 3]);
        assert_eq!(welded.keys, [keys[0], keys[1], keys[3]]);
    }

    #[test]
    fn many_keys_stay_apart() {
        let welded = welded(100_000, |i| [i as u32 % 50_000, 1, 0]);
        assert_eq!(welded.firsts.len(), 50_000);
        assert!(welded.numbers.iter().enumerate().all(|(i, &n)| n as usize == i % 50_000));
    }

    /// A key of which all have the same hash, as somebody could find keys who has the time.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    struct Chosen(u32);

    impl Key for Chosen {
        fn hash(self) -> u64 {
            7
        }
    }

    #[test]
    fn keys_chosen_to_collide_are_sorted() {
        let key = |i: usize| Chosen((i as u32).wrapping_mul(2_654_435_761) % 40_000);
        assert!(hashed(100_000, key).is_none());
        assert_eq!(welded(100_000, key), sorted(100_000, key));
    }

    #[test]
    fn sorting_gives_the_same_numbers() {
        let key = |i: usize| [(i * i % 1009) as u32, (i % 3) as u32, 0];
        assert_eq!(hashed(20_000, key).unwrap(), sorted(20_000, key));
    }
}
