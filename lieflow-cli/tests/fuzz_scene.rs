//! The scene parser on bundled scenes with bytes changed, cut and doubled: a scene, or an error that
//! says something.
#![allow(unreachable_pub)] // the body is public to the crate in fuzz/

#[path = "../../fuzz/src/scene.rs"]
mod scene;

use std::path::Path;

/// A generator of few lines: the parser needs variety, not statistics.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 33) as usize
}

#[test]
fn any_text() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut texts = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the scenes") {
        texts.push(std::fs::read(entry.expect("a file").path()).expect("a scene"));
    }
    assert!(texts.len() > 3);
    let pieces: [&[u8]; 12] = [
        b"nan",
        b"-inf",
        b"1e400",
        b"-1",
        b"0",
        b"[",
        b"]",
        b"=",
        b"\"",
        b"\n",
        b"\xff",
        b"99999999999999999999",
    ];
    let mut state = 7;
    for _ in 0..4_000 {
        let mut text = texts[next(&mut state) % texts.len()].clone();
        for _ in 0..1 + next(&mut state) % 4 {
            let at = next(&mut state) % (text.len() + 1);
            match next(&mut state) % 4 {
                0 => text.truncate(at),
                1 => drop(text.drain(at..(at + next(&mut state) % 12).min(text.len()))),
                2 if at < text.len() => text[at] = next(&mut state) as u8,
                _ => {
                    let piece = pieces[next(&mut state) % pieces.len()];
                    text.splice(at..at, piece.iter().copied());
                }
            }
        }
        scene::parse(&text);
    }
}
