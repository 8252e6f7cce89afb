//! Methods by name for runs that choose their own steps.

use super::*;
use crate::methods::{Doubling, Embedded, Metric};
use crate::problems::{PointOf, ScalarOf};

/// What to do with a method that estimates its own error, whatever its type: mostly
/// [`integrate_adaptive`](crate::adaptive::integrate_adaptive).
pub trait OnEmbedded<P: Problem> {
    /// The answer.
    type Out;
    /// Do it.
    fn call<M: Embedded<P>>(self, method: M) -> Self::Out;
}

/// An [`OnMethod`] for any of the functions of this module: it hands the method over with an estimate
/// by [`Doubling`].
#[derive(Clone, Copy, Debug)]
pub struct Doubled<V>(pub V);

impl<P: Problem, V: OnEmbedded<P>> OnMethod<P> for Doubled<V>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    type Out = V::Out;
    fn call<M: Method<P>>(self, method: M) -> V::Out {
        self.0.call(Doubling(method))
    }
}

/// Find the method that `spec` names, with its parts, and hand it over with its error estimate: that
/// of its embedded pair where it has one ([`MethodSpec::has_pair`]), of [`Doubling`] where not.
///
/// ```
/// use lieflow::SaveAt;
/// use lieflow::adaptive::{Adaptive, AdaptiveError, AdaptiveStats, integrate_adaptive};
/// use lieflow::catalog::{MethodSpec, OnEmbedded, with_embedded_method};
/// use lieflow::methods::Embedded;
/// use lieflow::problems::RigidBody;
/// use nalgebra::Vector3;
///
/// struct Run<'a>(&'a RigidBody, &'a mut Vector3<f64>);
/// impl OnEmbedded<RigidBody> for Run<'_> {
///     type Out = Result<AdaptiveStats, AdaptiveError>;
///     fn call<M: Embedded<RigidBody>>(self, method: M) -> Self::Out {
///         let control = Adaptive::new(1e-9, 1e-12)?;
///         integrate_adaptive(self.0, &method, [0.0, 10.0], &control, &SaveAt::Ends, self.1, |_, _| {})
///     }
/// }
///
/// let body = RigidBody::new([1.0, 2.0, 3.0])?;
/// let mut m = Vector3::new(0.2, 0.0, 3.0);
/// let dopri5 = MethodSpec { tableau: Some("dopri5".into()), ..MethodSpec::new("rkmk", Some("cay")) };
/// with_embedded_method(&dopri5, Run(&body, &mut m))??;
/// with_embedded_method(&MethodSpec::new("cf4", None), Run(&body, &mut m))??;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`with_method`].
pub fn with_embedded_method<P: Ambient, V: OnEmbedded<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: CatalogGroup,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
{
    each_method!(spec, Doubled(on), each_map, OnMethod::<P>::call, pair => estimated)
}

/// Find the embedded pair that `spec` names, with its parts, and hand it over. As
/// [`with_embedded_method`], without the code for the methods that would be doubled.
///
/// # Errors
/// As [`with_method`], and [`Error::Unsupported`] for a method without a pair
/// ([`MethodSpec::has_pair`]).
pub fn with_embedded_pair<P: Ambient, V: OnEmbedded<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: CatalogGroup,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
{
    only_pairs(spec, each_method!(spec, on, each_map, no_pair, pair => pair_of))
}

/// What a pair answered; without one, an error.
pub(super) fn only_pairs<T>(spec: &MethodSpec, out: Result<Option<T>, Error>) -> Result<T, Error> {
    out?.ok_or_else(|| Error::Unsupported {
        what: "an error estimate",
        with: format!("`{}`", spec.label()),
        why: "it has no embedded pair",
    })
}

pub(super) fn no_pair<P: Problem, V: OnEmbedded<P>, M: Method<P>>(_: V, _: M) -> Option<V::Out> {
    None
}

pub(super) fn pair_of<P: Problem, V: OnEmbedded<P>, M: Embedded<P>>(
    on: V,
    method: M,
) -> Option<V::Out> {
    Some(on.call(method))
}

/// Past the doubling, for a method that does not need it.
fn estimated<P: Problem, V: OnEmbedded<P>, M: Embedded<P>>(on: Doubled<V>, method: M) -> V::Out {
    on.0.call(method)
}

impl MethodSpec {
    /// Has the method an error estimate of its own? If not, [`with_embedded_method`] doubles its
    /// steps.
    ///
    /// # Errors
    /// As [`with_method`]; the map is not looked at.
    pub fn has_pair(&self) -> Result<bool, Error> {
        let info = self.info()?;
        Ok(match info.takes_tableau {
            true => each_tableau!(
                self.tableau.as_deref().unwrap_or("rk4"),
                t => Ok(t.error.is_some()),
                pair => Ok(t.error.is_some())
            )?,
            false => ["magnus43", "cf43", "cf-ls32"].contains(&info.name),
        })
    }
}
