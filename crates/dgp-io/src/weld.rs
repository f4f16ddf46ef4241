//! Equal keys under one number, counted in the order in which they first appear.

/// Which items are equal.
pub(crate) struct Welded {
    /// The number of each item.
    pub(crate) numbers: Vec<u32>,
    /// The first item of each number.
    pub(crate) firsts: Vec<u32>,
}

/// Numbers `len` items so that those with equal keys share a number.
pub(crate) fn weld<const N: usize>(len: usize, key: impl Fn(usize) -> [u64; N]) -> Welded {
    let mut numbers = Vec::with_capacity(len);
    let mut firsts: Vec<u32> = Vec::new();
    // Open addressing, at most half full; a slot holds a number plus 1.
    let mut slots = vec![0_u32; 1024];
    for i in 0..len {
        if 2 * firsts.len() >= slots.len() {
            slots = rehashed(2 * slots.len(), &firsts, &key);
        }
        let found = key(i);
        let mut slot = hash(found) as usize & (slots.len() - 1);
        let number = loop {
            match slots[slot] {
                0 => {
                    firsts.push(i as u32);
                    slots[slot] = firsts.len() as u32;
                    break firsts.len() as u32 - 1;
                }
                taken if key(firsts[taken as usize - 1] as usize) == found => break taken - 1,
                _ => slot = (slot + 1) & (slots.len() - 1),
            }
        };
        numbers.push(number);
    }
    Welded { numbers, firsts }
}

fn rehashed<const N: usize>(
    len: usize,
    firsts: &[u32],
    key: impl Fn(usize) -> [u64; N],
) -> Vec<u32> {
    let mut slots = vec![0_u32; len];
    for (number, &first) in firsts.iter().enumerate() {
        let mut slot = hash(key(first as usize)) as usize & (len - 1);
        while slots[slot] != 0 {
            slot = (slot + 1) & (len - 1);
        }
        slots[slot] = number as u32 + 1;
    }
    slots
}

/// Both halves of a 128-bit product, which every bit of the key reaches.
#[inline]
fn hash<const N: usize>(key: [u64; N]) -> u64 {
    // Odd constants without structure: digits of π.
    key.iter().fold(0x243f_6a88_85a3_08d3, |state: u64, &word| {
        let product = u128::from(state ^ word) * 0xa409_3822_299f_31d1_u128;
        (product as u64) ^ ((product >> 64) as u64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_first_appearance() {
        let keys = [7, 3, 7, 9, 3];
        let welded = weld(keys.len(), |i| [keys[i]]);
        assert_eq!(welded.numbers, [0, 1, 0, 2, 1]);
        assert_eq!(welded.firsts, [0, 1, 3]);
    }

    #[test]
    fn many_keys_stay_apart() {
        let welded = weld(100_000, |i| [i as u64 % 50_000, 1]);
        assert_eq!(welded.firsts.len(), 50_000);
        assert!(welded.numbers.iter().enumerate().all(|(i, &n)| n as usize == i % 50_000));
    }
}
