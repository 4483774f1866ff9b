//! Which objects share a rest frame, and hence a BVH.

use super::planned::{PlannedFrame, PlannedObject};
use crate::accel::Bvh;
use crate::error::{Error, Result};
use crate::scene::model::Scene;

/// Objects by velocity, in the order of first appearance.
///
/// # Errors
/// More triangles in one frame than its BVH can hold.
pub(super) fn by_velocity(scene: &Scene, objects: &[PlannedObject]) -> Result<Vec<PlannedFrame>> {
    let mut frames: Vec<PlannedFrame> = Vec::new();
    for (index, (object, planned)) in scene.objects.iter().zip(objects).enumerate() {
        let same = |f: &&mut PlannedFrame| scene.objects[f.objects[0]].velocity == object.velocity;
        match frames.iter_mut().find(same) {
            Some(frame) => {
                frame.objects.push(index);
                frame.triangles += planned.triangles;
            }
            None => frames.push(PlannedFrame {
                beta: object.velocity.beta().to_array(),
                gamma: object.velocity.gamma(),
                objects: vec![index],
                triangles: planned.triangles,
            }),
        }
    }
    refuse_too_many(scene, &frames)?;
    Ok(frames)
}

/// Refuses rest frames with more triangles than a BVH can hold.
fn refuse_too_many(scene: &Scene, frames: &[PlannedFrame]) -> Result<()> {
    let most = Bvh::MAX_TRIANGLES as u64;
    let Some(frame) = frames.iter().find(|f| f.triangles > most) else {
        return Ok(());
    };
    Err(Error::unsupported(
        &scene.name,
        format!("object \"{}\"", scene.objects[frame.objects[0]].name),
        format!(
            "{} triangles at rest in one frame, with those of {} objects in all",
            frame.triangles,
            frame.objects.len()
        ),
        format!("at most {most} triangles per rest frame"),
    ))
}
