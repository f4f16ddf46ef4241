//! Round numbers on a scale.
//!
//! Reference: Heckbert, "Nice numbers for graph labels", Graphics Gems, 1990.

/// Multiples of 1, 2 or 5 times a power of ten in a range, and how to write them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) values: Vec<f64>,
    pub(crate) labels: Vec<String>,
}

/// Numbers with more digits than this before or after the point are written with an exponent.
const PLAIN_DIGITS: i32 = 4;

impl Ticks {
    /// About `count` of them between `low` and `high`, both included; one if the range is a point.
    pub(crate) fn new(low: f64, high: f64, count: usize) -> Self {
        let rough = (high / count.max(1) as f64 - low / count.max(1) as f64).max(0.0);
        let size = low.abs().max(high.abs());
        // Steps that cannot be told apart from rounding are none.
        if rough.is_nan() || rough <= size * 1e-12 || rough < 1e-300 {
            return Ticks { values: vec![low], labels: vec![general(low)] };
        }
        let mut exponent = rough.log10().floor() as i32;
        let mut factor = rough / 10_f64.powi(exponent);
        factor = match factor {
            ..1.5 => 1.0,
            ..3.0 => 2.0,
            ..7.0 => 5.0,
            _ => 10.0,
        };
        if factor == 10.0 {
            (factor, exponent) = (1.0, exponent + 1);
        }
        let step = factor * 10_f64.powi(exponent);
        // A hair outside counts as inside: 0.3 is a multiple of 0.1.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let steps = (last - first) as usize;
        let values: Vec<f64> = (0..=steps).map(|i| (first + i as f64) * step).collect();
        let largest = size.log10().floor() as i32;
        let plain = largest < PLAIN_DIGITS + 1 && exponent >= -PLAIN_DIGITS;
        let label = |&x: &f64| {
            let x = if x.abs() < 0.5 * step { 0.0 } else { x };
            if plain || x == 0.0 {
                return format!("{x:.*}", if plain { (-exponent).max(0) as usize } else { 0 });
            }
            // As many digits as tell neighbors apart.
            let digits = x.abs().log10().floor() as i32 - exponent;
            format!("{x:.*e}", digits.clamp(0, 12) as usize)
        };
        let labels = values.iter().map(label).collect();
        Ticks { values, labels }
    }
}

/// A number by itself.
fn general(x: f64) -> String {
    let plain = x == 0.0 || (1e-4..1e5).contains(&x.abs());
    if plain { format!("{}", (x * 1e6).round() / 1e6) } else { format!("{x:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        Ticks::new(low, high, 5).labels
    }

    #[test]
    fn steps_are_round() {
        assert_eq!(labels(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-0.13, 0.31), ["-0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(3.0, 170.0), ["50", "100", "150"]);
        assert_eq!(labels(-1.0, 1.0), ["-1.0", "-0.5", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn large_and_small_numbers_have_exponents() {
        assert_eq!(labels(0.0, 1e-7), ["0", "2e-8", "4e-8", "6e-8", "8e-8", "1.0e-7"]);
        assert_eq!(labels(1e300, 1.4e300)[0], "1.0e300");
    }

    #[test]
    fn every_range_ends() {
        assert_eq!(labels(2.5, 2.5), ["2.5"]);
        assert_eq!(labels(0.0, 0.0), ["0"]);
        for (low, high) in [(f64::MIN, f64::MAX), (0.0, f64::MIN_POSITIVE), (1.0, 1.0 + 1e-15)] {
            let ticks = Ticks::new(low, high, 5);
            assert!((1..=11).contains(&ticks.values.len()), "{low}..{high}: {ticks:?}");
            assert!(ticks.values.iter().all(|x| x.is_finite()));
        }
    }
}
