//! A branch-free tanh that the compiler vectorises, accurate to a few units in the last place.
//!
//! ```text
//! tanh x = m / (m + 2),   m = exp(2x) - 1 = 2^n (exp(r) - 1) + (2^n - 1),   2x = n ln 2 + r
//! ```
//!
//! exp(r) - 1 is computed by its Taylor series on |r| <= ln(2) / 2, where the first omitted term is
//! below 1.3e-17 of the sum.

use pulp::{Simd, WithSimd};

/// 1 / 2!, 1 / 3!, ..., 1 / 13!.
const INVERSE_FACTORIALS: [f64; 12] = {
    let mut table = [0.0; 12];
    let mut factorial = 1.0;
    let mut k = 0;
    while k < table.len() {
        factorial *= (k + 2) as f64;
        table[k] = 1.0 / factorial;
        k += 1;
    }
    table
};

/// ln 2 in two parts; products of the first with n <= 2^20 are exact.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Rounding constant: adding it to a number below 2^51 leaves the nearest integer in the low bits
/// of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Beyond this argument tanh is 1 to machine precision; the limit keeps exp(2x) finite.
const SATURATED: f64 = 20.0;

/// Whether the vectors of `S` multiply and add in one instruction. Elsewhere that would be a library
/// call.
pub(crate) const fn fuses<S: Simd>() -> bool {
    S::F64_LANES >= 4
}

/// tanh of one number; NaN gives NaN. With `fused`, a constant, products are added without rounding.
#[inline(always)]
pub(crate) fn tanh(x: f64, fused: bool) -> f64 {
    let multiply_add = |a: f64, b: f64, c: f64| if fused { a.mul_add(b, c) } else { a * b + c };
    let y = 2.0 * x.abs().clamp(0.0, SATURATED);
    let shifted = multiply_add(y, std::f64::consts::LOG2_E, ROUND);
    let n = shifted - ROUND;
    let r = multiply_add(-n, LN_2_LOW, multiply_add(-n, LN_2_HIGH, y));
    let mut series = 0.0;
    for &coefficient in INVERSE_FACTORIALS.iter().rev() {
        series = multiply_add(series, r, coefficient);
    }
    let expm1_r = multiply_add(r * r, series, r);
    let two_to_n = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1.0_f64.to_bits()));
    let m = multiply_add(two_to_n, expm1_r, two_to_n - 1.0);
    (m / (m + 2.0)).copysign(x)
}

/// tanh of every number in place, computed in float64, for training.
pub fn tanh_in_place(values: &mut [f32]) {
    struct All<'a>(&'a mut [f32]);
    impl WithSimd for All<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            for value in self.0 {
                *value = tanh(f64::from(*value), fuses::<S>()) as f32;
            }
        }
    }
    pulp::Arch::new().dispatch(All(values));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both(x: f64) -> [f64; 2] {
        [true, false].map(|fused| tanh(x, fused))
    }

    #[test]
    fn agrees_with_the_standard_library_to_a_few_ulp() {
        let mut worst = 0.0_f64;
        for i in 0..400_000 {
            let x = (0.0001 * f64::from(i) - 20.0) * 1.05;
            for x in [x, 1e-3 * x, 1e-9 * x] {
                let expected = x.tanh();
                if expected != 0.0 {
                    worst = both(x)
                        .map(|y| (y / expected - 1.0).abs())
                        .into_iter()
                        .fold(worst, f64::max);
                }
            }
        }
        assert!(worst <= 4.0 * f64::EPSILON, "{worst:e}");
    }

    #[test]
    fn in_place_results_are_correctly_rounded_to_float32() {
        let numbers: Vec<f32> = (0..1000).map(|i| 0.01 * i as f32 - 5.0).collect();
        let mut values = numbers.clone();
        tanh_in_place(&mut values);
        for (x, value) in numbers.into_iter().zip(values) {
            assert_eq!(value, f64::from(x).tanh() as f32);
        }
    }

    #[test]
    fn is_odd_and_handles_special_values() {
        for x in [1e-300, 0.3, 1.0, 19.9, 25.0, 1e300, f64::INFINITY] {
            assert_eq!(both(-x), both(x).map(|y| -y));
        }
        assert_eq!(both(0.0), [0.0; 2]);
        assert_eq!(both(f64::INFINITY), [1.0; 2]);
        assert!(both(f64::NAN).into_iter().all(f64::is_nan));
    }
}
