//! Animations of nodes (glTF 2.0 §3.11): the position and direction of a node over time.
//!
//! Each channel sets translation, rotation or scale of a node through a sampler: values at ascending times, interpolated in between. With t
//! the fraction of the interval from time k to k + 1, d its length in seconds, a and b the values at its ends,
//!
//! ```text
//! LINEAR        a + t (b − a);   of rotations along the shorter arc: (sin((1 − t)φ) a ± sin(tφ) b)/sin φ,  cos φ = |a·b|
//! CUBICSPLINE   (2t³ − 3t² + 1) a + d (t³ − 2t² + t) m_a + (3t² − 2t³) b + d (t³ − t²) m_b,   m_a the out-, m_b the in-tangent
//! ```
//!
//! and constant before the first and after the last time. STEP is refused: jumps are faster than light.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ::gltf::json::Index;
use ::gltf::json::accessor::Accessor;
use ::gltf::json::animation::{Animation, Interpolation, Property, Sampler};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::accessor::{self, Layout, Purpose};
use super::buffers::Buffers;
use super::camera;
use super::document::{Document, label, listed, shortened};
use super::nodes::{Hierarchy, NO_ROTATION, local, named, parents, placing};
use super::summary::refuse_outside;
use super::warnings::Warnings;
use crate::Result;

/// The path of a node.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GltfTrack {
    /// Seconds, ascending, and the node's origin, metres, in the coordinates of the file's root.
    pub points: Vec<(f64, DVec3)>,
    /// Whether the node moves straight from each point to the next, at constant velocity: this is so if the animation only translates
    /// nodes, linearly. Otherwise the points lie on a curve.
    pub is_straight: bool,
    /// Whether the node also rotates along its path.
    pub turns: bool,
    /// The rotation from the node's pose without the animation to that at each point.
    pub rotations: Vec<DQuat>,
}

impl GltfTrack {
    /// The same at a time: between points along the shorter arc, and constant before the first and after the last.
    pub fn rotation(&self, seconds: f64) -> DQuat {
        let after = self.points.partition_point(|(time, _)| *time <= seconds);
        let begin = after.min(self.rotations.len().max(1) - 1).max(1) - 1;
        let (Some([(start, _), (end, _)]), Some([from, to])) = (
            self.points.get(begin..begin + 2),
            self.rotations.get(begin..begin + 2),
        ) else {
            return DQuat::IDENTITY;
        };
        let way = ((seconds - start) / (end - start)).clamp(0.0, 1.0);
        DQuat::from_array(slerp(from.to_array(), to.to_array(), way)).normalize()
    }
}

/// Number of segments between two times if the path is curved.
const PIECES: usize = 8;
/// A node turns if an axis changes by more than this relative amount: ten times the rounding error of f32.
const TURN: f64 = 1e-6;
/// The maximum number of points of a track.
const MOST: usize = 100_000;
/// The maximum number of values of all channels together, 40 bytes each with their times: keys that several channels share are read for
/// each of them.
const MOST_VALUES: usize = 1_000_000;
/// The maximum number of transforms from which a track is computed, a second or two of work: those of 100 nodes or channels at all points.
const MOST_STEPS: usize = 100 * MOST;

/// The values of a channel.
struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    times: Vec<f64>,
    /// One value per time; for splines three: in-tangent, value, out-tangent.
    values: Vec<[f64; 4]>,
}

/// The path of the origin of the node named `node`, in the animation named `animation` or the only one.
pub(super) fn track(
    document: &mut Document,
    node: &str,
    animation: Option<&str>,
) -> Result<GltfTrack> {
    refuse_outside(
        document,
        "put the file beside it, or export the model as one .glb",
    )?;
    let target = named(document, node)?;
    let index = chosen(document, animation)?;
    let chain = chain(document, target)?;
    let channels = channels(document, index, &chain)?;
    let place = document.node_label(target);
    if channels.is_empty() {
        let what = format!("{} does not move it", animation_label(document, index));
        let help = "name a node that the animation moves, or one below such a node";
        return Err(document.invalid(place, what, help));
    }
    let times = times(&channels);
    let steps = times.len().saturating_mul(chain.len() + channels.len());
    if times.len() > MOST || steps > MOST_STEPS {
        let what = format!(
            "its path has {} points, each by {} nodes and {} channels",
            times.len(),
            chain.len(),
            channels.len()
        );
        let help = format!(
            "at most {MOST} points, and {MOST_STEPS} times nodes and channels: export fewer keys"
        );
        return Err(document.invalid(place, what, help));
    }
    // In the order of the file: if two channels set the same property, the last one wins.
    let mut by_node = BTreeMap::<usize, Vec<&Channel>>::new();
    for channel in &channels {
        by_node.entry(channel.node).or_default().push(channel);
    }
    let own = |node| by_node.get(node).map_or(&[][..], Vec::as_slice);
    let posed = (chain.iter())
        .map(|node| Posed::new(document, *node, own(node)))
        .collect::<Result<Vec<_>>>()?;
    let still = Hierarchy::new(document, &mut Warnings::default())?.world(target);
    let still = directions(still).unwrap_or_default();
    let (mut points, mut turned) = (Vec::new(), Vec::new());
    for seconds in times {
        let world = (posed.iter()).fold(DAffine3::IDENTITY, |world, node| world * node.at(seconds));
        points.push((seconds, world.translation));
        // Scale does not turn anything; where it is 0, directions are those before.
        let before = turned.last().copied().unwrap_or(still);
        turned.push(directions(world).unwrap_or(before));
    }
    if !points.iter().all(|(_, x)| x.is_finite()) {
        let what = "its path goes beyond the range of numbers";
        return Err(document.invalid(place, what, "all points must be finite"));
    }
    let turns = |d: &DMat3| {
        let [y, z] = [d.y_axis - turned[0].y_axis, d.z_axis - turned[0].z_axis];
        y.length() > TURN || z.length() > TURN
    };
    let rotation = |d: &DMat3| DQuat::from_mat3(&(*d * still.transpose())).normalize();
    Ok(GltfTrack {
        points,
        is_straight: is_straight(&channels),
        turns: turned.iter().any(turns),
        rotations: turned.iter().map(rotation).collect(),
    })
}

/// Right, up and back of a node, as of a camera; `None` if its transform is singular or mirrors.
fn directions(world: DAffine3) -> Option<DMat3> {
    let [right, up, forward] = camera::orthonormal(world)?;
    Some(DMat3::from_cols(right, up, -forward))
}

/// The animation with this name, or the only one.
fn chosen(document: &Document, name: Option<&str>) -> Result<usize> {
    let all = &document.root.animations;
    let is_called = |a: &Animation| name.is_none() || a.name.as_deref() == name;
    let found: Vec<usize> = (0..all.len()).filter(|&i| is_called(&all[i])).collect();
    if let [index] = found[..] {
        return Ok(index);
    }
    let what = match (name, found.len()) {
        (Some(name), 0) => format!("the file has no animation {:?}", shortened(name)),
        (_, 0) => "the file has no animation".to_owned(),
        (_, count) => format!("there are {count} animations to choose from"),
    };
    let names = listed(all.iter().filter_map(|a| a.name.as_deref()));
    Err(document.invalid(
        "animations",
        what,
        format!("the animations of the file: {names}"),
    ))
}

fn animation_label(document: &Document, index: usize) -> String {
    let animation = document.root.animations.get(index);
    label(
        "animation",
        index,
        animation.and_then(|a| a.name.as_deref()),
    )
}

/// A node and its ancestors, starting at the root.
fn chain(document: &Document, node: usize) -> Result<Vec<usize>> {
    // Building the hierarchy proves that it has no cycles.
    Hierarchy::new(document, &mut Warnings::default())?;
    let parents = parents(document);
    let above = |&node: &usize| parents.get(node).copied().flatten();
    let mut chain: Vec<usize> = std::iter::successors(Some(node), above).collect();
    chain.reverse();
    Ok(chain)
}

/// The channels of an animation that move one of the nodes.
fn channels(document: &mut Document, animation: usize, nodes: &[usize]) -> Result<Vec<Channel>> {
    let name = animation_label(document, animation);
    // Copied from the document first, as reading accessors borrows it.
    let nodes: BTreeSet<usize> = nodes.iter().copied().collect();
    let described = document.root.animations[animation].channels.iter();
    let described: Vec<_> = described
        .enumerate()
        .map(|(k, c)| (k, c.target.node.value(), c.target.path, c.sampler))
        .filter(|(_, node, ..)| nodes.contains(node))
        .collect();
    let mut channels = Vec::new();
    let mut left = MOST_VALUES;
    for (k, node, path, sampler) in described {
        let place = format!("{name}, channel {k} ({})", document.node_label(node));
        let Checked::Valid(property) = path else {
            let help = "\"translation\", \"rotation\", \"scale\" or \"weights\"";
            return Err(document.invalid(place, "its path is not one that glTF defines", help));
        };
        // Weights do not move nodes.
        if property == Property::MorphTargetWeights {
            continue;
        }
        // The matrix would have to be decomposed, and glTF 2.0 (§3.11) does not allow such nodes.
        if document.root.nodes[node].matrix.is_some() {
            let what = "the node has a `matrix`, which animated nodes must not have in glTF";
            let help = "give the node `translation`, `rotation` and `scale` in its place";
            return Err(document.invalid(place, what, help));
        }
        let samplers = &document.root.animations[animation].samplers;
        let Some(Sampler {
            input,
            output,
            interpolation,
            ..
        }) = samplers.get(sampler.value())
        else {
            let what = format!("sampler {} does not exist", sampler.value());
            return Err(document.invalid(place, what, "every index must be within its list"));
        };
        let (input, output, interpolation) = (*input, *output, *interpolation);
        let Checked::Valid(interpolation) = interpolation else {
            let help = "\"LINEAR\", \"STEP\" or \"CUBICSPLINE\"";
            return Err(document.invalid(place, "its interpolation is not valid in glTF", help));
        };
        if interpolation == Interpolation::Step {
            let what = "it moves in steps (STEP), and jumps are faster than light";
            return Err(document.invalid(place, what, "export the animation with linear keys"));
        }
        channels.push(read(
            document,
            &place,
            (node, property, interpolation),
            (input, output),
            &mut left,
        )?);
    }
    Ok(channels)
}

fn read(
    document: &mut Document,
    place: &str,
    (node, property, interpolation): (usize, Property, Interpolation),
    (input, output): (Index<Accessor>, Index<Accessor>),
    left: &mut usize,
) -> Result<Channel> {
    let purpose = match property {
        Property::Rotation => Purpose::Rotations,
        _ => Purpose::Vectors,
    };
    let [input, output] = [(input, Purpose::Times), (output, purpose)]
        .map(|(index, purpose)| Layout::new(document, index, purpose, place));
    let (input, output) = (input?, output?);
    // A cubic spline has a tangent before and after each value (glTF 2.0, appendix C).
    let per_time = match interpolation {
        Interpolation::CubicSpline => 3,
        _ => 1,
    };
    if output.count != per_time * input.count || input.count > MOST as u64 {
        let what = format!("it has {} times and {} values", input.count, output.count);
        let help = format!("{per_time} values for each time, and at most {MOST} times");
        return Err(document.invalid(place, what, help));
    }
    // At this point `MOST` bounds both counts, whatever the file says, and `MOST_VALUES` bounds the sum over all channels.
    let Some(rest) = left.checked_sub(output.count as usize) else {
        let what = format!("including it, the channels have more than {MOST_VALUES} values");
        let help = "export fewer keys, and none for nodes that do not move";
        return Err(document.invalid(place, what, help));
    };
    *left = rest;
    let mut times = vec![0.0; input.count as usize];
    let mut values = vec![[0.0; 4]; output.count as usize];
    let mut buffers = Buffers::new(document);
    accessor::read::<1>(&mut buffers, &input, &mut |at, [t]| times[at as usize] = t)?;
    match property {
        Property::Rotation => accessor::read::<4>(&mut buffers, &output, &mut |at, q| {
            values[at as usize] = q;
        })?,
        _ => accessor::read::<3>(&mut buffers, &output, &mut |at, [x, y, z]| {
            values[at as usize] = [x, y, z, 0.0];
        })?,
    }
    let refuse = |what: String| Err(document.invalid(place, what, "export the animation again"));
    if let Some(key) = times.iter().position(|time| !time.is_finite()) {
        return refuse(format!("the time of key {key} is {}", times[key]));
    }
    if let Some(key) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        let (before, after) = (times[key], times[key + 1]);
        let next = key + 1;
        return refuse(format!(
            "its times do not ascend: key {key} is at {before} s, and key {next} at {after} s"
        ));
    }
    let is_finite = |value: &[f64; 4]| value.iter().all(|v| v.is_finite());
    if let Some(number) = values.iter().position(|value| !is_finite(value)) {
        return refuse(format!("its value {number} is not finite"));
    }
    Ok(Channel {
        node,
        property,
        interpolation,
        times,
        values,
    })
}

/// Whether the path is straight between the times of all channels: a sum of linear translations, with constant rotations and scales.
fn is_straight(channels: &[Channel]) -> bool {
    channels
        .iter()
        .all(|c| c.property == Property::Translation && c.interpolation == Interpolation::Linear)
}

/// All times at which a channel has values, and some in between where the path is curved.
fn times(channels: &[Channel]) -> Vec<f64> {
    let mut times: Vec<f64> = channels
        .iter()
        .flat_map(|c| c.times.iter().copied())
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    if is_straight(channels) {
        return times;
    }
    let mut all = Vec::with_capacity(PIECES * times.len());
    for pair in times.windows(2) {
        let step = (pair[1] - pair[0]) / PIECES as f64;
        all.extend((0..PIECES).map(|k| pair[0] + k as f64 * step));
    }
    all.extend(times.last());
    all
}

/// A node and the channels that move it.
struct Posed<'c> {
    /// Its own transform if no channel moves it.
    rest: DAffine3,
    translation: DVec3,
    rotation: [f64; 4],
    scale: DVec3,
    channels: Vec<&'c Channel>,
}

impl<'c> Posed<'c> {
    fn new(document: &Document, node: usize, own: &[&'c Channel]) -> Result<Self> {
        let numbers = document.transforms.get(node);
        Ok(Posed {
            rest: local(document, node, &mut Warnings::default())?,
            translation: (numbers.and_then(|n| n.translation))
                .map_or(DVec3::ZERO, DVec3::from_array),
            rotation: (numbers.and_then(|n| n.rotation)).unwrap_or(NO_ROTATION),
            scale: (numbers.and_then(|n| n.scale)).map_or(DVec3::ONE, DVec3::from_array),
            channels: own.to_vec(),
        })
    }

    /// Its own transform at a time.
    fn at(&self, seconds: f64) -> DAffine3 {
        if self.channels.is_empty() {
            return self.rest;
        }
        let (mut translation, mut rotation, mut scale) =
            (self.translation, self.rotation, self.scale);
        for channel in &self.channels {
            let [x, y, z, w] = channel.at(seconds);
            match channel.property {
                Property::Translation => translation = DVec3::new(x, y, z),
                Property::Scale => scale = DVec3::new(x, y, z),
                Property::Rotation => rotation = [x, y, z, w],
                Property::MorphTargetWeights => {}
            }
        }
        let norm = rotation.iter().map(|c| c * c).sum();
        placing(translation, (rotation, norm), scale)
    }
}

impl Channel {
    /// The value at a time.
    fn at(&self, seconds: f64) -> [f64; 4] {
        let after = self.times.partition_point(|t| *t <= seconds);
        let last = self.times.len() - 1;
        if after == 0 || after > last {
            return self.value(if after == 0 { 0 } else { last });
        }
        let (k, d) = (after - 1, self.times[after] - self.times[after - 1]);
        let t = (seconds - self.times[k]) / d;
        let (a, b) = (self.value(k), self.value(after));
        match (self.interpolation, self.property) {
            (Interpolation::CubicSpline, _) => {
                let (out, into) = (self.values[3 * k + 2], self.values[3 * after]);
                let (t2, t3) = (t * t, t * t * t);
                std::array::from_fn(|i| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
                        + d * (t3 - 2.0 * t2 + t) * out[i]
                        + (3.0 * t2 - 2.0 * t3) * b[i]
                        + d * (t3 - t2) * into[i]
                })
            }
            (_, Property::Rotation) => slerp(a, b, t),
            _ => std::array::from_fn(|i| a[i] + t * (b[i] - a[i])),
        }
    }

    fn value(&self, k: usize) -> [f64; 4] {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * k + 1],
            _ => self.values[k],
        }
    }
}

/// Interpolates along the shorter arc between two unit quaternions.
fn slerp(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let dot: f64 = (0..4).map(|i| a[i] * b[i]).sum();
    let angle = libm::acos(dot.abs().min(1.0));
    let (from, to) = match angle > 1e-6 {
        true => (libm::sin((1.0 - t) * angle), libm::sin(t * angle)),
        false => (1.0 - t, t),
    };
    std::array::from_fn(|i| from * a[i] + to * b[i] * dot.signum())
}

/// The result of [`track`] for the file at `path`.
pub(super) fn load(path: &Path, node: &str, animation: Option<&str>) -> Result<GltfTrack> {
    track(&mut Document::open(path)?, node, animation)
}
