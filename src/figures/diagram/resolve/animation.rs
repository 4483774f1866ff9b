//! `[diagram.animation]`.

use super::names::Names;
use super::settings;
use crate::error::Result;
use crate::figures::diagram::file;
use crate::figures::diagram::model::{Animation, Boost, Sweep};
use crate::io::image::film::Delay;
use crate::scene::At;

/// The most pictures.
const MOST: u32 = 10_000;
const DEFAULT_FRAMES: u32 = 72;
const DEFAULT_FPS: f64 = 24.0;

/// The animation of a diagram that is drawn in `views`.
pub(super) fn resolve(
    names: &mut Names,
    file: &file::Diagram,
    views: &[usize],
) -> Result<Option<Animation>> {
    let Some(at) = &file.animation else {
        return Ok(None);
    };
    let animation = &at.value;
    if animation.boost_to.is_none() && animation.now.is_none() {
        let help = "add boost_to = \"S'\", or now = { from = 0, to = 5 }";
        return Err(names
            .cx
            .refuse(at, "nothing changes in this animation", help));
    }
    let fps = settings::positive(names.cx, &animation.fps, "`fps`")?;
    if let (Some(at), Some(fps)) = (&animation.fps, fps)
        && Delay::of_rate(fps).is_err()
    {
        let what = "files cannot state this rate: it is no fraction of numbers up to 65535";
        return Err(names.cx.refuse(at, what, "give a rate like 25 or 29.97"));
    }
    Ok(Some(Animation {
        frames: frames(names, &animation.frames)?,
        fps: fps.unwrap_or(DEFAULT_FPS),
        boost: boost(names, animation, views)?,
        sweep: sweep(names, &animation.now)?,
    }))
}

fn frames(names: &Names, at: &Option<At<u32>>) -> Result<u32> {
    match at {
        None => Ok(DEFAULT_FRAMES),
        Some(at) if (2..=MOST).contains(&at.value) => Ok(at.value),
        Some(at) => {
            let what = format!("{} pictures do not make an animation", at.value);
            Err(names.cx.refuse(at, what, format!("give 2 to {MOST}")))
        }
    }
}

fn boost(names: &mut Names, animation: &file::Animation, views: &[usize]) -> Result<Option<Boost>> {
    let Some(name) = &animation.boost_to else {
        return Ok(None);
    };
    let to = Some(name.clone());
    let (to, target) = names.frame(&to)?;
    let &[from] = views else {
        let what = "a diagram with several views side by side is not boosted";
        let help = "let `view` be one frame: that of the first picture";
        return Err(names.cx.refuse(name, what, help));
    };
    if from == to {
        let what = "the diagram is drawn in this frame already";
        let help = "name another frame, or another one in `view`";
        return Err(names.cx.refuse(name, what, help));
    }
    // Two frames may each be slow enough for the world, and too fast for each other.
    let from = names.frame_at(from, &name.span)?;
    if let Err(error) = target.velocity().relative_to(from.velocity()) {
        return Err(names
            .cx
            .refuse(name, error.to_string(), "name a slower frame"));
    }
    Ok(Some(Boost {
        to,
        back: animation.back.unwrap_or(false),
    }))
}

fn sweep(names: &mut Names, at: &Option<At<file::Now>>) -> Result<Option<Sweep>> {
    let Some(at) = at else { return Ok(None) };
    let now = &at.value;
    let (frame, _) = names.frame(&now.frame)?;
    let times = [&now.from, &now.to].map(|time| time.value.0 * names.unit);
    if times[0] == times[1] {
        let what = "this line of simultaneity stays where it is";
        return Err(names.cx.refuse(at, what, "let `from` and `to` differ"));
    }
    Ok(Some(Sweep {
        frame,
        times,
        colour: now.colour,
    }))
}
