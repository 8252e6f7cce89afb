//! The motion of a body as a figure that a reader plays.

use lieflow::so3::{quaternion_from_matrix, quaternion_to_wxyz};
use lieflow_figures::number::short;
use lieflow_figures::{Body, Pose};
use lieflow_model::problem::PrincipalInertia;
use lieflow_model::schema::{Observable, Row};
use nalgebra::Matrix3;

use super::sample::RowSample;

/// The turns that are shown, in radians: forty.
const SHOWN: f64 = 250.0;
/// Turns between two poses that are shown: the least, and the most that still tells how the body turned.
const LEAST: f64 = 0.06;
const MOST: f64 = 1.2;

/// The body of a run whose rows have the attitude or the quaternion often enough.
pub(super) fn body(inertia: &PrincipalInertia, rows: &RowSample<'_>) -> Option<Body> {
    let of_attitude =
        |quantity: &&Observable| quantity.parts.len() == 1 && quantity.parts[0].measure.is_angle();
    let turned = rows.schema().iter().find(of_attitude)?;
    let pose = |(t, row): (f64, Row<'_>)| Some(Pose { t, quaternion: quaternion(&row[turned])? });
    let whole = poses(rows.rows().map_while(pose));
    let poses = whole.or_else(|| poses(rows.first().map_while(pose)))?;
    let (start, end) = (poses.first()?.t, poses.last()?.t);
    let whole = rows.ends().is_some_and(|[_, (t, _)]| t == end);
    let part = if whole {
        String::new()
    } else {
        format!(" Shown is t = {} to {}.", short(start, 4), short(end, 4))
    };
    Some(Body {
        id: "body".into(),
        title: "The body as it turns in space".into(),
        sides: inertia.sides_of_a_box(),
        axes: inertia.axes,
        poses,
        caption: format!(
            "A box with the same moments of inertia. The line is the way of its longest axis. e₁, e₂, e₃ are \
             the axes of space.{part}"
        ),
        view: (35.0, 25.0),
    })
}

/// The attitude in a row, by its four or nine numbers.
fn quaternion(numbers: &[f64]) -> Option<[f64; 4]> {
    match *numbers {
        [w, x, y, z] => Some([w, x, y, z]),
        _ if numbers.len() == 9 => {
            let matrix = Matrix3::from_row_slice(numbers);
            quaternion_from_matrix(&matrix).ok().map(|q| quaternion_to_wxyz(&q))
        }
        _ => None,
    }
}

/// The poses of the first turns, or none if they are too far apart.
fn poses(all: impl Iterator<Item = Pose>) -> Option<Vec<Pose>> {
    let mut kept: Vec<Pose> = Vec::new();
    let (mut turned, mut waiting) = (0.0, None);
    for mut pose in all {
        let Some(last) = kept.last() else {
            kept.push(pose);
            continue;
        };
        let cosine: f64 = last.quaternion.iter().zip(&pose.quaternion).map(|(a, b)| a * b).sum();
        if cosine < 0.0 {
            pose.quaternion = pose.quaternion.map(|x| -x);
        }
        let angle = 2.0 * cosine.abs().min(1.0).acos();
        if angle > MOST {
            return None;
        }
        waiting = Some(pose);
        if angle >= LEAST {
            turned += angle;
            kept.extend(waiting.take());
        }
        if turned > SHOWN {
            return Some(kept);
        }
    }
    kept.extend(waiting);
    (kept.len() > 1).then_some(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// About the third axis by so much for each pose.
    fn turning(by: f64, count: usize) -> impl Iterator<Item = Pose> {
        (0..count).map(move |i| {
            let half = 0.5 * by * i as f64;
            Pose { t: i as f64, quaternion: [half.cos(), 0.0, 0.0, half.sin()] }
        })
    }

    #[test]
    fn poses_are_neither_too_near_nor_too_far() {
        let near = poses(turning(0.01, 1001)).unwrap();
        assert!((140..180).contains(&near.len()), "{}", near.len());
        assert_eq!(near.last().map(|pose| pose.t), Some(1000.0));
        assert!(poses(turning(1.5, 10)).is_none());
        assert_eq!(poses(turning(1.0, 1000)).unwrap().len(), 252);
        // q and −q are the same attitude: the next pose is the nearer of both.
        let signs = near.windows(2).all(|pair| {
            let cosine: f64 =
                pair[0].quaternion.iter().zip(&pair[1].quaternion).map(|(a, b)| a * b).sum();
            cosine > 0.0
        });
        assert!(signs);
    }
}
