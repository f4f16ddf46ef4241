//! Equal points by an open hash table over their bits.

use glam::DVec3;

use super::Welding;
use crate::{VertexId, VertexMap};

/// How many slots a point may cost on average before the points count as chosen to collide.
const PROBE_LIMIT: usize = 64;

pub(super) fn weld(points: &[DVec3]) -> Welding {
    hashed(points).unwrap_or_else(|| weld_sorted(points))
}

/// The welding, or `None` if far too many points collide.
fn hashed(points: &[DVec3]) -> Option<Welding> {
    // A closed triangle mesh as a soup has six corners a vertex: two slots an expected vertex.
    let mut table = Table::new((points.len() / 3).next_power_of_two().max(64));
    let mut probes = PROBE_LIMIT * points.len() + 4096;
    let mut originals = Vec::with_capacity(points.len() / 6 + 1);
    let mut vertices = Vec::with_capacity(points.len());
    for (i, &point) in points.iter().enumerate() {
        let new = table.find_or_insert(bits(point), &mut probes)?;
        if new == originals.len() {
            originals.push(VertexId::new(i));
        }
        vertices.push(VertexId::new(new));
    }
    Some(Welding { vertices: vertices.into(), originals: originals.into() })
}

/// The same by sorting, for points that defeat the hash.
pub(super) fn weld_sorted(points: &[DVec3]) -> Welding {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    let key = |i: u32| (bits(points[i as usize]), i);
    order.sort_unstable_by_key(|&i| key(i));
    let mut first: Vec<u32> = vec![0; points.len()];
    for group in order.chunk_by(|&i, &j| key(i).0 == key(j).0) {
        for &i in group {
            first[i as usize] = group[0];
        }
    }
    from_firsts(&first)
}

/// The welding in which point i goes into point `first[i] ≤ i`, which goes into itself.
pub(super) fn from_firsts(first: &[u32]) -> Welding {
    let mut originals = VertexMap::new();
    let mut vertices: Vec<VertexId> = Vec::with_capacity(first.len());
    for (i, &f) in first.iter().enumerate() {
        let original = f as usize == i;
        let new = if original { originals.push(VertexId::new(i)) } else { vertices[f as usize] };
        vertices.push(new);
    }
    Welding { vertices: vertices.into(), originals }
}

/// Open addressing with linear probing: slots hold the number of a key plus one, zero where empty.
struct Table {
    slots: Vec<u32>,
    keys: Vec<[u64; 3]>,
    shift: u32,
}

impl Table {
    fn new(slots: usize) -> Self {
        Table { slots: vec![0; slots], keys: Vec::new(), shift: 64 - slots.trailing_zeros() }
    }

    /// The number of `key`; takes what it costs off `probes`, `None` when they are used up.
    #[inline]
    fn find_or_insert(&mut self, key: [u64; 3], probes: &mut usize) -> Option<usize> {
        let mask = self.slots.len() - 1;
        let mut slot = (hash(key) >> self.shift) as usize;
        loop {
            let entry = self.slots[slot];
            if entry == 0 {
                break;
            }
            if self.keys[entry as usize - 1] == key {
                return Some(entry as usize - 1);
            }
            *probes = probes.checked_sub(1)?;
            slot = (slot + 1) & mask;
        }
        self.keys.push(key);
        self.slots[slot] = self.keys.len() as u32;
        if self.keys.len() * 2 > self.slots.len() {
            self.grow();
        }
        Some(self.keys.len() - 1)
    }

    fn grow(&mut self) {
        let count = self.slots.len() * 4;
        self.slots.clear();
        self.slots.resize(count, 0);
        self.shift -= 2;
        for (i, &key) in self.keys.iter().enumerate() {
            let mut slot = (hash(key) >> self.shift) as usize;
            while self.slots[slot] != 0 {
                slot = (slot + 1) & (count - 1);
            }
            self.slots[slot] = i as u32 + 1;
        }
    }
}

/// The bits of the coordinates, the same for −0 and 0.
#[inline]
fn bits(point: DVec3) -> [u64; 3] {
    // Adding 0 turns −0 into 0 and leaves all else.
    [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits())
}

/// 64 well mixed bits: products of 64 × 64 bits, upper half folded into the lower.
#[inline]
fn hash([x, y, z]: [u64; 3]) -> u64 {
    let fold = |a: u64, b: u64| {
        let product = u128::from(a) * u128::from(b);
        (product >> 64) as u64 ^ product as u64
    };
    // Digits of π, as good as any odd numbers with half of their bits set.
    let xy = fold(x ^ 0x243f_6a88_85a3_08d3, y ^ 0x1319_8a2e_0370_7344);
    fold(xy ^ z, 0xa409_3822_299f_31d1)
}
