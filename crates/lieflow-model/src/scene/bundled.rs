//! The scenes that come with the program.

use lieflow::names::same;

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bundled {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! bundled {
    ($($name:literal),* $(,)?) => {
        &[$(Bundled {
            name: $name,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
        }),*]
    };
}

/// The scenes, in the order of the list that `lieflow scenes` prints.
pub const BUNDLED: &[Bundled] = bundled![
    "asymmetric-top",
    "symmetric-top",
    "high-energy",
    "adaptive-top",
    "tumbling-attitude",
    "wing-nut",
    "flips",
    "general-layer",
    "flipping-book",
    "damped-satellite",
    "magnetic-damping",
    "attitude-control",
    "saturated-control",
    "many-bodies",
    "manakov-body",
    "lagrange-top",
    "nutating-top",
    "kovalevskaya-top",
    "general-top",
    "ellipsoid-in-fluid",
    "euler-on-sl3",
    "cubic-anisotropy",
    "vortices-on-sphere",
    "shear-layer",
    "rolling-turn",
    "spherical-pendulum",
    "rotating-field",
    "spin-wave",
    "relaxing-spins",
    "chiral-spin-wave",
    "toda-lattice",
    "sorting",
    "qr-flow",
    "oja",
    "subspaces",
    "mathieu",
    "coupled-oscillators",
    "fodo-cell",
    "riccati-pole",
    "crossed-fields",
    "rabi",
    "three-level-transfer",
    "landau-zener",
    "stirap",
    "thermal-qubit",
    "rotating-drive",
    "lorenz",
    "spin-and-oscillator",
    "gyro-record",
    "gyrostat",
    "spin-pair",
];

/// The files that these scenes name.
const FILES: &[(&str, &str)] = &[("gyro.csv", include_str!("../../scenes/gyro.csv"))];

/// The text of a file that comes with the program.
pub(super) fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

impl Bundled {
    /// The scene of that name.
    pub fn named(name: &str) -> Option<&'static Bundled> {
        BUNDLED.iter().find(|scene| same(scene.name, name))
    }

    /// The first paragraph of the comment that the scene starts with.
    pub fn description(&self) -> String {
        let comment = self.text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
        comment.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
    }
}
