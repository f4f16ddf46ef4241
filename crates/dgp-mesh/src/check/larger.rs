//! Whether something is smaller than something else in all of six numbers, such as a box in another.
//!
//! The largest and smallest numbers of a group decide for many at once; groups are halved where the
//! spread is largest, until they decide or are small.
//!
//! - Cost: O(n log n) for boxes as they lie beside or in each other in space; O(n²) at worst.

/// So many pairs are tried one by one.
const FEW: usize = 16;

/// Which of `items` have one of `others` larger than themselves in all numbers.
pub(super) fn have_larger(items: &[[f64; 6]], others: &[[f64; 6]]) -> Vec<bool> {
    let mut found = vec![false; items.len()];
    let mut order: Vec<u32> = (0..others.len() as u32).collect();
    search(items, (0..items.len() as u32).collect(), others, &mut order, &mut found);
    found
}

fn search(
    items: &[[f64; 6]],
    mut asking: Vec<u32>,
    others: &[[f64; 6]],
    group: &mut [u32],
    found: &mut [bool],
) {
    let item = |i: u32| &items[i as usize];
    if group.len() <= FEW {
        for i in asking {
            found[i as usize] |= group.iter().any(|&j| is_larger(&others[j as usize], item(i)));
        }
        return;
    }
    let (mut least, mut most) = ([f64::INFINITY; 6], [f64::NEG_INFINITY; 6]);
    for &j in &*group {
        for (k, &x) in others[j as usize].iter().enumerate() {
            (least[k], most[k]) = (least[k].min(x), most[k].max(x));
        }
    }
    asking.retain(|&i| {
        found[i as usize] |= is_larger(&least, item(i));
        !found[i as usize] && is_larger(&most, item(i))
    });
    if asking.is_empty() {
        return;
    }
    let spread = |k: &usize| most[*k] - least[*k];
    let widest = (0..6).max_by(|j, k| spread(j).total_cmp(&spread(k))).unwrap_or(0);
    let middle = group.len() / 2;
    let key = |j: u32| others[j as usize][widest];
    group.select_nth_unstable_by(middle, |&i, &j| key(i).total_cmp(&key(j)));
    let (low, high) = group.split_at_mut(middle);
    // The larger ones answer more of the questions.
    search(items, asking.clone(), others, high, found);
    asking.retain(|&i| !found[i as usize]);
    search(items, asking, others, low, found);
}

fn is_larger(a: &[f64; 6], b: &[f64; 6]) -> bool {
    a.iter().zip(b).all(|(a, b)| a > b)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_finds_what_trying_all_finds(
            items in prop::collection::vec(prop::array::uniform6(0_u8..8), 0..60),
            others in prop::collection::vec(prop::array::uniform6(0_u8..8), 0..120),
        ) {
            let items: Vec<_> = items.iter().map(|item| item.map(f64::from)).collect();
            let others: Vec<_> = others.iter().map(|item| item.map(f64::from)).collect();
            let all = items.iter().map(|item| others.iter().any(|other| is_larger(other, item)));
            prop_assert_eq!(have_larger(&items, &others), all.collect::<Vec<_>>());
        }
    }
}
