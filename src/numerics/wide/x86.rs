//! The vectors of x86-64: four numbers with AVX2, eight with AVX-512. Pairs, which processors without AVX2 have, gain too little for a
//! third copy of the code.
//!
//! The vector types are private. Only tasks run by [`Vectors::run`] or [`with_directions`] make values of them: [`Vectors::at_most`] makes a
//! [`Vectors`], and `with_directions` runs its task, only if the processor has the instructions.

use std::arch::x86_64::*;

use crate::numerics::wide::directions::DirectionVector;
use crate::numerics::wide::{Array, BELOW_EXPONENT, DirectionsTask, Four, MAX_LANES, Simd, TO_EXPONENT, Task, Wide};

/// A vector type that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vectors(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    Avx2,
    Avx512,
}

impl Vectors {
    pub fn at_most(lanes: usize) -> Option<Vectors> {
        if lanes >= F64x8::LANES && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
            Some(Vectors(Set::Avx512))
        } else {
            (lanes >= F64x4::LANES && is_x86_feature_detected!("avx2")).then_some(Vectors(Set::Avx2))
        }
    }

    pub fn lanes(self) -> usize {
        match self.0 {
            Set::Avx2 => F64x4::LANES,
            Set::Avx512 => F64x8::LANES,
        }
    }

    pub fn run<T: Task>(self, task: T) -> T::Output {
        match self.0 {
            // SAFETY: only `at_most` makes this variant, after finding AVX2 on the processor.
            Set::Avx2 => unsafe { with_avx2(task) },
            // SAFETY: only `at_most` makes this variant, after finding AVX512F and AVX512DQ on the processor.
            Set::Avx512 => unsafe { with_avx512(task) },
        }
    }
}

#[inline(always)]
pub fn with_directions<T: DirectionsTask>(task: T) -> Option<T::Output> {
    // SAFETY: the processor has AVX2.
    is_x86_feature_detected!("avx2").then(|| unsafe { directions_with_avx2(task) })
}

#[target_feature(enable = "avx2")]
fn directions_with_avx2<T: DirectionsTask>(task: T) -> T::Output {
    task.run::<Wide<F64x4>>()
}

#[target_feature(enable = "avx2")]
fn with_avx2<T: Task>(task: T) -> T::Output {
    task.run::<F64x4>()
}

#[target_feature(enable = "avx512f,avx512dq")]
fn with_avx512<T: Task>(task: T) -> T::Output {
    task.run::<F64x8>()
}

/// A vector type with its intrinsics. The macro `$rest` has the operations whose form differs between the instruction sets.
macro_rules! vector {
    (
        $name:ident($vector:ty), $lanes:literal, $mask:ty, $rest:ident;
        $load:ident, $store:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident,
        $xor:ident, $andnot:ident
    ) => {
        #[derive(Clone, Copy)]
        struct $name($vector);

        impl Simd for $name {
            const LANES: usize = $lanes;
            type Mask = $mask;

            #[inline(always)]
            fn load(numbers: &Array) -> $name {
                // SAFETY: the array has at least `LANES` numbers; for the instruction, see the module.
                $name(unsafe { $load(numbers.as_ptr()) })
            }

            #[inline(always)]
            fn columns(rows: [&Four; MAX_LANES]) -> [$name; 4] {
                // SAFETY: each row has the four numbers that are read; for the instructions, see the module.
                let [a, b, c, d] = unsafe { $rest!(columns, rows) };
                [$name(a), $name(b), $name(c), $name(d)]
            }

            #[inline(always)]
            fn store(self) -> Array {
                let mut numbers = [0.0; MAX_LANES];
                // SAFETY: the array has room for `LANES` numbers; for the instruction, see the module.
                unsafe { $store(numbers.as_mut_ptr(), self.0) };
                numbers
            }

            #[inline(always)]
            fn splat(number: f64) -> $name {
                // SAFETY: this runs only if the processor has the instruction, see the module.
                $name(unsafe { $splat(number) })
            }

            #[inline(always)]
            fn add(self, other: $name) -> $name {
                // SAFETY: a value of this type exists only if the processor has the instruction, see the module.
                $name(unsafe { $add(self.0, other.0) })
            }

            #[inline(always)]
            fn sub(self, other: $name) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $sub(self.0, other.0) })
            }

            #[inline(always)]
            fn mul(self, other: $name) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $mul(self.0, other.0) })
            }

            #[inline(always)]
            fn div(self, other: $name) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $div(self.0, other.0) })
            }

            #[inline(always)]
            fn sqrt(self) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn neg(self) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $xor(self.0, $splat(-0.0)) })
            }

            #[inline(always)]
            fn abs(self) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $andnot($splat(-0.0), self.0) })
            }

            #[inline(always)]
            fn power_of_two(self) -> $name {
                let exponents = self.add($name::splat(TO_EXPONENT));
                // SAFETY: as in `add`.
                $name(unsafe { $rest!(shift, exponents.0) })
            }

            #[inline(always)]
            fn less(self, other: $name) -> $mask {
                // SAFETY: as in `add`.
                unsafe { $rest!(less, self.0, other.0) }
            }

            #[inline(always)]
            fn select(self, mask: $mask, other: $name) -> $name {
                // SAFETY: as in `add`.
                $name(unsafe { $rest!(select, mask, self.0, other.0) })
            }

            #[inline(always)]
            fn both(a: $mask, b: $mask) -> $mask {
                // SAFETY: as in `add`.
                unsafe { $rest!(both, a, b) }
            }

            #[inline(always)]
            fn either(a: $mask, b: $mask) -> $mask {
                // SAFETY: as in `add`.
                unsafe { $rest!(either, a, b) }
            }

            #[inline(always)]
            fn except(a: $mask, b: $mask) -> $mask {
                // SAFETY: as in `add`.
                unsafe { $rest!(except, a, b) }
            }

            #[inline(always)]
            fn bits(mask: $mask) -> u32 {
                // SAFETY: as in `add`.
                unsafe { $rest!(bits, mask) }
            }
        }
    };
}

macro_rules! avx2 {
    (columns, $rows:expr) => {{
        let rows: [&Four; MAX_LANES] = $rows;
        let (a, b) = (_mm256_loadu_pd(rows[0].as_ptr()), _mm256_loadu_pd(rows[1].as_ptr()));
        let (c, d) = (_mm256_loadu_pd(rows[2].as_ptr()), _mm256_loadu_pd(rows[3].as_ptr()));
        // Numbers 0 and 2, or 1 and 3, of two rows.
        let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (even_after, odd_after) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(even, even_after),
            _mm256_permute2f128_pd::<0x20>(odd, odd_after),
            _mm256_permute2f128_pd::<0x31>(even, even_after),
            _mm256_permute2f128_pd::<0x31>(odd, odd_after),
        ]
    }};
    (shift, $a:expr) => {
        _mm256_castsi256_pd(_mm256_slli_epi64::<{ BELOW_EXPONENT as _ }>(_mm256_castpd_si256($a)))
    };
    (less, $a:expr, $b:expr) => {
        _mm256_cmp_pd::<_CMP_LT_OQ>($a, $b)
    };
    (select, $mask:expr, $yes:expr, $no:expr) => {
        _mm256_blendv_pd($no, $yes, $mask)
    };
    (both, $a:expr, $b:expr) => {
        _mm256_and_pd($a, $b)
    };
    (either, $a:expr, $b:expr) => {
        _mm256_or_pd($a, $b)
    };
    (except, $a:expr, $b:expr) => {
        _mm256_andnot_pd($b, $a)
    };
    (bits, $mask:expr) => {
        _mm256_movemask_pd($mask) as u32
    };
}

macro_rules! avx512 {
    (two, $low:expr, $high:expr) => {
        _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(_mm256_loadu_pd($low.as_ptr())), _mm256_loadu_pd($high.as_ptr()))
    };
    (columns, $rows:expr) => {{
        let rows: [&Four; MAX_LANES] = $rows;
        let (a, b) = (avx512!(two, rows[0], rows[2]), avx512!(two, rows[1], rows[3]));
        let (c, d) = (avx512!(two, rows[4], rows[6]), avx512!(two, rows[5], rows[7]));
        // Numbers 0 and 2, or 1 and 3, of four rows.
        let (even, odd) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
        let (even_after, odd_after) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
        [
            _mm512_shuffle_f64x2::<0x88>(even, even_after),
            _mm512_shuffle_f64x2::<0x88>(odd, odd_after),
            _mm512_shuffle_f64x2::<0xdd>(even, even_after),
            _mm512_shuffle_f64x2::<0xdd>(odd, odd_after),
        ]
    }};
    (shift, $a:expr) => {
        _mm512_castsi512_pd(_mm512_slli_epi64::<{ BELOW_EXPONENT as _ }>(_mm512_castpd_si512($a)))
    };
    (less, $a:expr, $b:expr) => {
        _mm512_cmp_pd_mask::<_CMP_LT_OQ>($a, $b)
    };
    (select, $mask:expr, $yes:expr, $no:expr) => {
        _mm512_mask_blend_pd($mask, $no, $yes)
    };
    (both, $a:expr, $b:expr) => {
        _kand_mask8($a, $b)
    };
    (either, $a:expr, $b:expr) => {
        _kor_mask8($a, $b)
    };
    (except, $a:expr, $b:expr) => {
        _kandn_mask8($b, $a)
    };
    (bits, $mask:expr) => {
        _cvtmask8_u32($mask)
    };
}

vector!(
    F64x4(__m256d), 4, __m256d, avx2;
    _mm256_loadu_pd, _mm256_storeu_pd, _mm256_set1_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd,
    _mm256_sqrt_pd, _mm256_xor_pd, _mm256_andnot_pd
);
vector!(
    F64x8(__m512d), 8, __mmask8, avx512;
    _mm512_loadu_pd, _mm512_storeu_pd, _mm512_set1_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd,
    _mm512_sqrt_pd, _mm512_xor_pd, _mm512_andnot_pd
);

impl DirectionVector for F64x4 {}
