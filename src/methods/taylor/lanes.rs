//! Operations on four numbers (x, y, z, w) at once, by the instructions of the machine for doubles, else on arrays.

#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::{__m256d, __m512d};

use crate::scalar::{Counted, DoubleDouble, Real};
use crate::space::Numbers;

/// The operations of the recurrences, on a quaternion with the vector part first, or on a vector with w = 0.
pub trait Lanes<S>: Copy {
    /// Four numbers.
    type V: Copy;
    /// A pair of those. Some machines have one instruction for both.
    type W: Copy;
    /// True if the recurrences are to be compiled term by term.
    const IS_UNROLLED: bool;

    fn load(self, x: [S; 4]) -> Self::V;
    fn store(self, v: Self::V) -> [S; 4];
    fn splat(self, x: S) -> Self::V;
    fn pair(self, v: [Self::V; 2]) -> Self::W;
    /// The two of a pair.
    fn halves(self, w: Self::W) -> [Self::V; 2];
    fn add(self, a: Self::V, b: Self::V) -> Self::V;
    fn mul(self, a: Self::V, b: Self::V) -> Self::V;
    /// a·b + c.
    fn mul_add(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// a·b − c.
    fn mul_sub(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// a·b + c of pairs.
    fn mul_add_pairs(self, a: Self::W, b: Self::W, c: Self::W) -> Self::W;
    /// (y, z, x, w) and (z, x, y, w).
    fn cycled(self, v: Self::V) -> [Self::V; 2];
    /// (x, x, x, x), (y, y, y, y), (z, z, z, z).
    fn spread(self, v: Self::V) -> [Self::V; 3];
    /// q ∘ e₁, q ∘ e₂, q ∘ e₃.
    fn products(self, q: Self::V) -> [Self::V; 3];
}

/// Arrays, for any number and any machine.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl<S: Real> Lanes<S> for Plain {
    type V = [S; 4];
    type W = [[S; 4]; 2];
    const IS_UNROLLED: bool = false;

    #[inline(always)]
    fn pair(self, v: [[S; 4]; 2]) -> [[S; 4]; 2] {
        v
    }
    #[inline(always)]
    fn halves(self, w: [[S; 4]; 2]) -> [[S; 4]; 2] {
        w
    }
    #[inline(always)]
    fn mul_add_pairs(self, a: [[S; 4]; 2], b: [[S; 4]; 2], c: [[S; 4]; 2]) -> [[S; 4]; 2] {
        let at = |i: usize| Lanes::<S>::mul_add(self, a[i], b[i], c[i]);
        [at(0), at(1)]
    }

    #[inline(always)]
    fn load(self, x: [S; 4]) -> [S; 4] {
        x
    }
    #[inline(always)]
    fn store(self, v: [S; 4]) -> [S; 4] {
        v
    }
    #[inline(always)]
    fn splat(self, x: S) -> [S; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn add(self, a: [S; 4], b: [S; 4]) -> [S; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }
    #[inline(always)]
    fn mul(self, a: [S; 4], b: [S; 4]) -> [S; 4] {
        [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
    }
    #[inline(always)]
    fn mul_add(self, a: [S; 4], b: [S; 4], c: [S; 4]) -> [S; 4] {
        Lanes::<S>::add(self, Lanes::<S>::mul(self, a, b), c)
    }
    #[inline(always)]
    fn mul_sub(self, a: [S; 4], b: [S; 4], c: [S; 4]) -> [S; 4] {
        Lanes::<S>::add(self, Lanes::<S>::mul(self, a, b), [-c[0], -c[1], -c[2], -c[3]])
    }
    #[inline(always)]
    fn cycled(self, [x, y, z, w]: [S; 4]) -> [[S; 4]; 2] {
        [[y, z, x, w], [z, x, y, w]]
    }
    #[inline(always)]
    fn spread(self, [x, y, z, _]: [S; 4]) -> [[S; 4]; 3] {
        [[x; 4], [y; 4], [z; 4]]
    }
    #[inline(always)]
    fn products(self, [x, y, z, w]: [S; 4]) -> [[S; 4]; 3] {
        [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]]
    }
}

/// The instructions of the machine on four numbers and on pairs.
#[cfg(target_arch = "x86_64")]
macro_rules! x86_lanes {
    ($machine:ty, $pair:ty, {$($pairs:tt)*}) => {
        impl Lanes<f64> for $machine {
            type V = __m256d;
            type W = $pair;
            const IS_UNROLLED: bool = true;
            $($pairs)*

            #[inline(always)]
            fn load(self, [x, y, z, w]: [f64; 4]) -> Self::V {
                self.avx._mm256_setr_pd(x, y, z, w)
            }
            #[inline(always)]
            fn store(self, v: Self::V) -> [f64; 4] {
                pulp::cast(v)
            }
            #[inline(always)]
            fn splat(self, x: f64) -> Self::V {
                self.avx._mm256_set1_pd(x)
            }
            #[inline(always)]
            fn add(self, a: Self::V, b: Self::V) -> Self::V {
                self.avx._mm256_add_pd(a, b)
            }
            #[inline(always)]
            fn mul(self, a: Self::V, b: Self::V) -> Self::V {
                self.avx._mm256_mul_pd(a, b)
            }
            #[inline(always)]
            fn mul_add(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V {
                self.fma._mm256_fmadd_pd(a, b, c)
            }
            #[inline(always)]
            fn mul_sub(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V {
                self.fma._mm256_fmsub_pd(a, b, c)
            }
            #[inline(always)]
            fn cycled(self, v: Self::V) -> [Self::V; 2] {
                [
                    self.avx2._mm256_permute4x64_pd::<0b11_00_10_01>(v),
                    self.avx2._mm256_permute4x64_pd::<0b11_01_00_10>(v),
                ]
            }
            #[inline(always)]
            fn spread(self, v: Self::V) -> [Self::V; 3] {
                [
                    self.avx2._mm256_permute4x64_pd::<0b00_00_00_00>(v),
                    self.avx2._mm256_permute4x64_pd::<0b01_01_01_01>(v),
                    self.avx2._mm256_permute4x64_pd::<0b10_10_10_10>(v),
                ]
            }
            #[inline(always)]
            fn products(self, q: Self::V) -> [Self::V; 3] {
                let sign = |x: [f64; 4], v| self.avx._mm256_xor_pd(self.load(x), v);
                [
                    sign([0.0, 0.0, -0.0, -0.0], self.avx2._mm256_permute4x64_pd::<0b00_01_10_11>(q)),
                    sign([-0.0, 0.0, 0.0, -0.0], self.avx2._mm256_permute4x64_pd::<0b01_00_11_10>(q)),
                    sign([0.0, -0.0, 0.0, -0.0], self.avx2._mm256_permute4x64_pd::<0b10_11_00_01>(q)),
                ]
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
x86_lanes!(pulp::x86::V3, [__m256d; 2], {
    #[inline(always)]
    fn pair(self, v: [__m256d; 2]) -> [__m256d; 2] {
        v
    }
    #[inline(always)]
    fn halves(self, w: [__m256d; 2]) -> [__m256d; 2] {
        w
    }
    #[inline(always)]
    fn mul_add_pairs(self, a: [__m256d; 2], b: [__m256d; 2], c: [__m256d; 2]) -> [__m256d; 2] {
        [self.mul_add(a[0], b[0], c[0]), self.mul_add(a[1], b[1], c[1])]
    }
});

#[cfg(target_arch = "x86_64")]
x86_lanes!(pulp::x86::V4, __m512d, {
    #[inline(always)]
    fn pair(self, [low, high]: [__m256d; 2]) -> __m512d {
        self.avx512f._mm512_insertf64x4::<1>(self.avx512f._mm512_castpd256_pd512(low), high)
    }
    #[inline(always)]
    fn halves(self, w: __m512d) -> [__m256d; 2] {
        [self.avx512f._mm512_castpd512_pd256(w), self.avx512f._mm512_extractf64x4_pd::<1>(w)]
    }
    #[inline(always)]
    fn mul_add_pairs(self, a: __m512d, b: __m512d, c: __m512d) -> __m512d {
        self.avx512f._mm512_fmadd_pd(a, b, c)
    }
});

/// Work for lanes.
pub trait Kernel<S> {
    /// The result.
    type Out;
    /// Run the kernel. Inline, so that it is compiled for the instructions that it is given.
    fn run<L: Lanes<S>>(self, lanes: L) -> Self::Out;
}

/// Runs a kernel on arrays. It is compiled once for each kernel and number type, not for each problem.
#[inline(never)]
fn on_arrays<S: Real, K: Kernel<S>>(kernel: K) -> K::Out {
    kernel.run(Plain)
}

/// 1/(k+1).
pub(super) const INVERSE: [f64; 16] = {
    let mut table = [0.0; 16];
    let mut k = 0;
    while k < table.len() {
        table[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    table
};

/// A number that the recurrences run on.
pub trait Wide: Real + Numbers {
    /// 1/(k+1) for k < 16.
    #[doc(hidden)]
    #[inline(always)]
    fn inverse(k: usize) -> Self {
        Self::lit(INVERSE[k])
    }
    /// Runs a kernel with the fastest lanes for this number type.
    #[doc(hidden)]
    #[inline(always)]
    fn dispatch<K: Kernel<Self>>(kernel: K) -> K::Out {
        on_arrays(kernel)
    }
}

impl Wide for f32 {}
impl Wide for Counted {}
impl Wide for DoubleDouble {
    fn inverse(k: usize) -> Self {
        Self::lit(1.0) / Self::lit((k + 1) as f64)
    }
}

impl Wide for f64 {
    #[inline(always)]
    fn dispatch<K: Kernel<f64>>(kernel: K) -> K::Out {
        #[cfg(target_arch = "x86_64")]
        {
            struct On<M, K>(M, K);
            impl<M: Lanes<f64>, K: Kernel<f64>> pulp::NullaryFnOnce for On<M, K> {
                type Output = K::Out;
                #[inline(always)]
                fn call(self) -> K::Out {
                    self.1.run(self.0)
                }
            }
            if let Some(v4) = pulp::x86::V4::try_new() {
                return v4.vectorize(On(v4, kernel));
            }
            if let Some(v3) = pulp::x86::V3::try_new() {
                return v3.vectorize(On(v3, kernel));
            }
        }
        on_arrays(kernel)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::super::series::{At, Body, Momentum, OneStep, Quaternion, Unknown};
    use super::*;

    /// Every kind of lanes that this machine has gives the same step.
    fn lanes_agree(of: impl Unknown<f64>) {
        let body = Body::new(&Vector3::new(1.0, 0.25, 1.0 / 18.0));
        let m = Vector3::new(0.3, 2.75, -2.75);
        let mut terms = [[0.0; 4]; 16];
        let mut by = |run: &dyn Fn(OneStep<'_, f64, _, 16>) -> [f64; 4]| {
            let sum = run(OneStep { of, body: &body, h: 0.4, m, terms: &mut terms });
            let at_end = At { start: of.start(&m), terms: &terms, theta: 1.0 };
            assert_eq!(sum, f64::dispatch(at_end));
            sum
        };
        let expected = by(&|step| step.run(Plain));
        let close = |sum: [f64; 4]| {
            let error = sum.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Sums of 16 terms below the length, which grow to twice that in between.
            let length = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(error <= 16.0 * f64::EPSILON * length, "{sum:?} {expected:?}: {error:e}");
        };
        close(by(&|step| f64::dispatch(step)));
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = pulp::x86::V3::try_new() {
            close(by(&|step| step.run(v3)));
        }
    }

    #[test]
    fn lanes_agree_on_the_rotation() {
        lanes_agree(Quaternion);
    }

    #[test]
    fn lanes_agree_on_the_momentum() {
        lanes_agree(Momentum);
    }
}
