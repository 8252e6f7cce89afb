//! Fuzz targets of lieflow; the bodies are in [`bodies`] and [`scene`].

pub mod bodies;
mod draw;
pub mod scene;

#[doc(hidden)]
pub use libfuzzer_sys;

/// The entry point of the target of this name.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(|data: &[u8]| {
            for (name, body) in $crate::bodies::TARGETS {
                if *name == $name {
                    body(data);
                }
            }
        });
    };
}
