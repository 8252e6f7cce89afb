//! The checks of the library on this machine: its two layers against each other, the laws of every group
//! with every map, the exact motion.

use lieflow::check::{Finding, laws, maps_agree, steps_agree};
use lieflow::groups::{MatrixGroup, Sample, So3};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, CoordinateMap, Exp, NamedMap};
use lieflow::problems::Exact;
use nalgebra::Matrix3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::CliError;

/// The seed of the random inputs: the same numbers on every machine.
const SEED: u64 = 2003;

/// The maps of which the laws are checked: the first two on every group, all of them on SO(n).
const MAPS: [NamedMap; 5] = [
    NamedMap::Exp(Exp),
    NamedMap::Cay(Cay),
    NamedMap::Ccsk123(CCSK123),
    NamedMap::Ccsk321(CCSK321),
    NamedMap::Ccsk(CCSK),
];

/// Findings about one thing, with its name.
pub type Group = (String, Vec<Finding>);

/// The checks of layers, laws and the exact motion, with `cases` random vectors for the maps.
///
/// # Errors
/// A check that cannot be set up.
pub fn checks(cases: usize) -> Result<Vec<Group>, CliError> {
    let mut rng = Pcg64::seed_from_u64(SEED);
    let mut agree = maps_agree(&mut rng, cases)?;
    agree.extend(steps_agree(&mut rng, cases / 50)?);
    let mut groups = vec![("general code against the closed forms on so(3)".into(), agree)];
    groups.push(laws_on("closed", &So3::new(), &MAPS, &mut rng)?);
    for n in [3, 5, 10] {
        groups.push(laws_on("general", &MatrixGroup::so(n)?, &MAPS, &mut rng)?);
    }
    for group in [MatrixGroup::gl(3)?, MatrixGroup::sp(4)?, MatrixGroup::indefinite(3, 1)?] {
        groups.push(laws_on("general", &group, &MAPS[..2], &mut rng)?);
    }
    groups
        .push(("exact motion of a free body".into(), vec![exact_restarts(&mut rng, cases / 100)?]));
    Ok(groups)
}

/// The laws of a group on this layer with these maps.
fn laws_on<G>(layer: &str, group: &G, maps: &[NamedMap], rng: &mut Pcg64) -> Result<Group, CliError>
where
    G: Sample<Scalar = f64>,
    NamedMap: CoordinateMap<G>,
{
    let mut found = Vec::<Finding>::new();
    for psi in maps {
        // The law of the bracket does not know the map: once a group is enough.
        let is_new = |law: &Finding| found.iter().all(|known| known.name != law.name);
        let laws: Vec<_> = laws(group, psi, rng, 100, 0.3)?.into_iter().filter(is_new).collect();
        found.extend(laws);
    }
    Ok((format!("laws on {} ({layer})", group.name()), found))
}

/// The exact motion taken at once, and in two parts: m and g at random bodies, in units of the
/// rounding of the angle that was turned.
fn exact_restarts(rng: &mut Pcg64, cases: usize) -> Result<Finding, CliError> {
    let mut finding = Finding {
        name: "exact motion: restart at t/3".into(),
        cases,
        worst: 0.0,
        at: String::new(),
        bound: 32.0,
    };
    for _ in 0..cases {
        let inertia = [(); 3].map(|()| rng.random_range(0.5..3.0));
        let momentum = [(); 3].map(|()| rng.random_range(-1.0..1.0));
        let t = rng.random_range(0.1..20.0);
        let whole = Exact::new(inertia, momentum, Matrix3::identity())?;
        let (m, g) = whole.state(t)?;
        let (m1, g1) = whole.state(t / 3.0)?;
        let (m2, g2) = Exact::new(inertia, m1.into(), g1)?.state(t - t / 3.0)?;
        // A rounding of m moves the end by ε t |m|/J times what the orbit stretches, which near
        // the separatrix is exponential in λt.
        let speed = m.norm() / 0.5;
        let stretch = 1.0 + speed * t;
        let gap = (g - g2).norm().max((m - m2).norm() / m.norm());
        let growth = {
            let [x, y, z] = momentum;
            let nudged = [x * (1.0 + 1e-9), y, z];
            let (m3, g3) = Exact::new(inertia, nudged, Matrix3::identity())?.state(t)?;
            ((g - g3).norm() + (m - m3).norm() / m.norm()) / 1e-9
        };
        let units = gap / (f64::EPSILON * stretch.max(growth));
        if units > finding.worst || units.is_nan() {
            (finding.worst, finding.at) =
                (units, format!("J = {inertia:?}, m = {momentum:?}, t = {t}"));
        }
    }
    Ok(finding)
}
