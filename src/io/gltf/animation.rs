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
//!
//! Each of these has a rate per second, and with the angular velocity ω = 2 q′ q*/|q|² (its vector part) of a rotation q, whatever its length,
//! transforms have one, too: (T R S)′ moves by T′ and turns by [ω]× R S + R S′, and (A B)′ = A′ B + A B′. The path of a node does not depend on
//! its own rotation and scale. If only nodes are translated, it is a cubic between any two keys; if nodes above it turn or grow, it is
//! replaced by cubics through places and velocities of the path, in pieces that are halved until they agree with it.

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
    /// The velocities just before and just after each point, metres per second. From each point to the next the path is the cubic that has
    /// these at its ends.
    pub velocities: Vec<[DVec3; 2]>,
    /// Whether the node also rotates along its path.
    pub turns: bool,
    /// The node and those above it, starting at the root.
    chain: Vec<Posed>,
    /// Its directions without the animation.
    still: DMat3,
}

impl GltfTrack {
    /// The rotation from the node's pose without the animation to that at a time.
    pub fn rotation(&self, seconds: f64) -> DQuat {
        let turned = turned(&self.chain, seconds).unwrap_or(self.still);
        DQuat::from_mat3(&(turned * self.still.transpose())).normalize()
    }
}

/// The smallest number of pieces between two times if nodes turn or grow.
const PIECES: usize = 8;
/// How far the cubics may be from the path, relative to the length of the piece from which halving starts.
const TOLERANCE: f64 = 1e-9;
/// A node turns if an axis changes by more than this relative amount: ten times the rounding error of f32.
const TURN: f64 = 1e-6;
/// The maximum number of points of a track.
const MOST: usize = 100_000;
/// The maximum number of values of all channels together, 40 bytes each with their times: keys that several channels share are read for
/// each of them.
const MOST_VALUES: usize = 1_000_000;
/// The maximum number of transforms at the points of a track before halving, of which six times as many are computed in all, a few seconds
/// of work: those of 100 nodes or channels at all points.
const MOST_STEPS: usize = 100 * MOST;

/// The values of a channel.
#[derive(Debug, Clone, PartialEq)]
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
    let mut keys: Vec<f64> = (channels.iter()).flat_map(|c| c.times.clone()).collect();
    keys.sort_by(f64::total_cmp);
    keys.dedup();
    let reshapes = |c: &Channel| c.property != Property::Translation;
    let bends = (channels.iter()).any(|c| c.node != target && reshapes(c));
    let times = match channels.iter().any(reshapes) {
        true => divided(&keys),
        false => keys.clone(),
    };
    let parts = chain.len() + channels.len();
    let refuse = |document: &Document, points: usize| {
        let what = format!(
            "its path has {points} points, each by {} nodes and {} channels",
            chain.len(),
            parts - chain.len()
        );
        let help = format!(
            "at most {MOST} points, and {MOST_STEPS} times nodes and channels: export fewer keys"
        );
        Err(document.invalid(place.clone(), what, help))
    };
    if times.len() > MOST || times.len().saturating_mul(parts) > MOST_STEPS {
        return refuse(document, times.len());
    }
    // In the order of the file: if two channels set the same property, the last one wins.
    let mut by_node = BTreeMap::<usize, Vec<Channel>>::new();
    for channel in channels {
        by_node.entry(channel.node).or_default().push(channel);
    }
    let posed = (chain.iter())
        .map(|node| Posed::new(document, *node, by_node.remove(node).unwrap_or_default()))
        .collect::<Result<Vec<_>>>()?;
    let mut course = Course {
        chain: &posed,
        left: 6 * MOST_STEPS / parts,
        points: Vec::new(),
        velocities: Vec::new(),
    };
    course.follow(if bends { &times } else { &keys }, bends);
    let Course {
        left,
        points,
        velocities,
        ..
    } = course;
    if left == 0 || points.len() > MOST {
        return refuse(document, points.len());
    }
    let is_finite = |[a, b]: &[DVec3; 2]| a.is_finite() && b.is_finite();
    if !points.iter().all(|(_, x)| x.is_finite()) || !velocities.iter().all(is_finite) {
        let what = "its path goes beyond the range of numbers";
        return Err(document.invalid(place, what, "all points must be finite"));
    }
    let still = Hierarchy::new(document, &mut Warnings::default())?.world(target);
    let still = directions(still).unwrap_or_default();
    let axes = |seconds: &f64| turned(&posed, *seconds).unwrap_or(still);
    let first = times.first().map_or(still, axes);
    let turns = |seconds: &f64| {
        let d = axes(seconds);
        let [y, z] = [d.y_axis - first.y_axis, d.z_axis - first.z_axis];
        y.length() > TURN || z.length() > TURN
    };
    Ok(GltfTrack {
        points,
        velocities,
        turns: times.iter().any(turns),
        chain: posed,
        still,
    })
}

/// The directions of the last node of `chain` at a time; without all animated scales where these leave none.
fn turned(chain: &[Posed], seconds: f64) -> Option<DMat3> {
    let of = |scales: bool| directions(world(chain, [seconds; 2], scales).at);
    of(true).or_else(|| of(false))
}

/// The transform of the last node of `chain` at a time, by the keys around another one.
fn world(chain: &[Posed], times: [f64; 2], scales: bool) -> Moving {
    let start = Moving {
        at: DAffine3::IDENTITY,
        rate: DAffine3::ZERO,
    };
    (chain.iter()).fold(start, |world, node| world.then(node.at(times, scales)))
}

/// The path of a node, while it is computed.
struct Course<'c> {
    chain: &'c [Posed],
    /// The number of transforms left to compute it.
    left: usize,
    points: Vec<(f64, DVec3)>,
    velocities: Vec<[DVec3; 2]>,
}

/// A time, and place and velocity then.
#[derive(Clone, Copy)]
struct Moment {
    seconds: f64,
    x: DVec3,
    v: DVec3,
}

impl Course<'_> {
    /// Adds the path at `times`, which include all keys, and what is needed in between if it `bends`.
    fn follow(&mut self, times: &[f64], bends: bool) {
        for pair in times.windows(2) {
            let middle = pair[0].midpoint(pair[1]);
            let ends = [pair[0], pair[1]].map(|seconds| self.at([seconds, middle]));
            // The velocity may jump at the first of them.
            match (self.velocities.last_mut(), ends[0]) {
                (Some(velocities), Moment { v, .. }) => velocities[1] = v,
                (None, first) => self.add(first),
            }
            let reach =
                (ends[1].seconds - ends[0].seconds) * (ends[0].v.length() + ends[1].v.length());
            let rounding = 8.0 * f64::EPSILON * ends[0].x.abs().max(ends[1].x.abs()).max_element();
            match bends {
                true => self.halve(ends, TOLERANCE * reach + rounding),
                false => self.add(ends[1]),
            }
        }
        if let ([seconds], true) = (times, self.points.is_empty()) {
            let only = self.at([*seconds; 2]);
            self.add(only);
        }
    }

    fn at(&mut self, times: [f64; 2]) -> Moment {
        self.left = self.left.saturating_sub(1);
        let Moving { at, rate } = world(self.chain, times, true);
        Moment {
            seconds: times[0],
            x: at.translation,
            v: rate.translation,
        }
    }

    fn add(&mut self, Moment { seconds, x, v }: Moment) {
        self.points.push((seconds, x));
        self.velocities.push([v, v]);
    }

    /// Adds the points after the first of `ends` up to the second, so many that the cubics between them are this near to the path.
    fn halve(&mut self, ends: [Moment; 2], tolerance: f64) {
        let [a, b] = ends;
        let d = b.seconds - a.seconds;
        let within = [0.25, 0.5, 0.75].map(|t| (t, self.at([a.seconds + t * d; 2])));
        let is_far = within.iter().any(|(t, own)| {
            let [from, out, to, into] = hermite(*t)[0];
            let cubic = from * a.x + to * b.x + (out * a.v + into * b.v) * d;
            (cubic - own.x).length() > tolerance
        });
        let middle = within[1].1;
        let has_room = self.left > 0 && self.points.len() < MOST;
        if is_far && has_room && a.seconds < middle.seconds && middle.seconds < b.seconds {
            self.halve([a, middle], tolerance);
            self.halve([middle, b], tolerance);
        } else {
            self.add(b);
        }
    }
}

/// The weights of value and slope before and after in a cubic, at the fraction t of its interval, and their rates; those of slopes are to be
/// multiplied by its length.
fn hermite(t: f64) -> [[f64; 4]; 2] {
    let (t2, t3) = (t * t, t * t * t);
    let (to, bend) = (3.0 * t2 - 2.0 * t3, 6.0 * (t - t2));
    [
        [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, to, t3 - t2],
        [-bend, 3.0 * t2 - 4.0 * t + 1.0, bend, 3.0 * t2 - 2.0 * t],
    ]
}

/// A transform and its rate per second.
#[derive(Clone, Copy)]
struct Moving {
    at: DAffine3,
    rate: DAffine3,
}

impl Moving {
    /// The product with the transform of a node below.
    fn then(self, below: Moving) -> Moving {
        let (a, b) = (self.at.matrix3, below.at.matrix3);
        Moving {
            at: self.at * below.at,
            rate: DAffine3 {
                matrix3: self.rate.matrix3 * b + a * below.rate.matrix3,
                translation: self.rate.matrix3 * below.at.translation
                    + a * below.rate.translation
                    + self.rate.translation,
            },
        }
    }
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

/// `keys`, and more times in between.
fn divided(keys: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(PIECES * keys.len());
    for pair in keys.windows(2) {
        let step = (pair[1] - pair[0]) / PIECES as f64;
        all.extend((0..PIECES).map(|k| pair[0] + k as f64 * step));
    }
    all.extend(keys.last());
    all
}

/// A node and the channels that move it.
#[derive(Debug, Clone, PartialEq)]
struct Posed {
    /// Its own transform if no channel moves it.
    rest: DAffine3,
    translation: DVec3,
    rotation: [f64; 4],
    scale: DVec3,
    channels: Vec<Channel>,
}

impl Posed {
    fn new(document: &Document, node: usize, channels: Vec<Channel>) -> Result<Self> {
        let numbers = document.transforms.get(node);
        Ok(Posed {
            rest: local(document, node, &mut Warnings::default())?,
            translation: (numbers.and_then(|n| n.translation))
                .map_or(DVec3::ZERO, DVec3::from_array),
            rotation: (numbers.and_then(|n| n.rotation)).unwrap_or(NO_ROTATION),
            scale: (numbers.and_then(|n| n.scale)).map_or(DVec3::ONE, DVec3::from_array),
            channels,
        })
    }

    /// Its own transform at the first of two times, by the keys around the second; with scale 1 if `scales` is false.
    fn at(&self, times: [f64; 2], scales: bool) -> Moving {
        if self.channels.is_empty() {
            return Moving {
                at: self.rest,
                rate: DAffine3::ZERO,
            };
        }
        // Each with its rate.
        let still = |v: [f64; 4]| [v, [0.0; 4]];
        let mut translation = still(self.translation.extend(0.0).to_array());
        let mut rotation = still(self.rotation);
        let mut scale = still(self.scale.extend(0.0).to_array());
        for channel in &self.channels {
            let to = match channel.property {
                Property::Translation => &mut translation,
                Property::Scale => &mut scale,
                Property::Rotation => &mut rotation,
                Property::MorphTargetWeights => continue,
            };
            *to = channel.at(times);
        }
        if !scales {
            scale = still([1.0; 4]);
        }
        let [[translation, moves], [scale, grows]] =
            [translation, scale].map(|v| v.map(|[x, y, z, _]| DVec3::new(x, y, z)));
        let [q, rate] = rotation.map(|[x, y, z, w]| (DVec3::new(x, y, z), w));
        let norm = rotation[0].iter().map(|c| c * c).sum();
        let spin = (rate.0 * q.1 - q.0 * rate.1 - rate.0.cross(q.0)) * (2.0 / norm);
        let axes = placing(translation, (rotation[0], norm), DVec3::ONE).matrix3;
        let turned = axes * DMat3::from_diagonal(scale);
        let turns = |column: DVec3| spin.cross(column);
        let [x, y, z] = [turned.x_axis, turned.y_axis, turned.z_axis].map(turns);
        Moving {
            at: DAffine3 {
                matrix3: turned,
                translation,
            },
            rate: DAffine3 {
                matrix3: DMat3::from_cols(x, y, z) + axes * DMat3::from_diagonal(grows),
                translation: moves,
            },
        }
    }
}

impl Channel {
    /// The value at the first of two times, by the keys around the second, and its rate.
    fn at(&self, [seconds, within]: [f64; 2]) -> [[f64; 4]; 2] {
        let after = self.times.partition_point(|t| *t <= within);
        let last = self.times.len() - 1;
        if after == 0 || after > last {
            return [self.value(if after == 0 { 0 } else { last }), [0.0; 4]];
        }
        let (k, d) = (after - 1, self.times[after] - self.times[after - 1]);
        let t = (seconds - self.times[k]) / d;
        let (a, b) = (self.value(k), self.value(after));
        let [value, rate] = match (self.interpolation, self.property) {
            (Interpolation::CubicSpline, _) => {
                let (m, n) = (self.values[3 * k + 2], self.values[3 * after]);
                hermite(t).map(|[from, out, to, into]| {
                    std::array::from_fn(|i| {
                        from * a[i] + to * b[i] + d * (out * m[i] + into * n[i])
                    })
                })
            }
            (_, Property::Rotation) => slerp(a, b, t),
            _ => [[1.0 - t, t], [-1.0, 1.0]]
                .map(|[from, to]| std::array::from_fn(|i| from * a[i] + to * b[i])),
        };
        [value, rate.map(|r: f64| r / d)]
    }

    fn value(&self, k: usize) -> [f64; 4] {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * k + 1],
            _ => self.values[k],
        }
    }
}

/// A multiple of the quaternion between two unit quaternions, along the shorter arc, and its rate.
fn slerp(a: [f64; 4], b: [f64; 4], t: f64) -> [[f64; 4]; 2] {
    let dot: f64 = (0..4).map(|i| a[i] * b[i]).sum();
    let angle = libm::acos(dot.abs().min(1.0));
    let weights = match angle > 1e-6 {
        true => {
            let [left, gone] = [(1.0 - t) * angle, t * angle];
            [
                [libm::sin(left), libm::sin(gone)],
                [-angle * libm::cos(left), angle * libm::cos(gone)],
            ]
        }
        false => [[1.0 - t, t], [-1.0, 1.0]],
    };
    weights.map(|[from, to]| std::array::from_fn(|i| from * a[i] + to * b[i] * dot.signum()))
}

/// The result of [`track`] for the file at `path`.
pub(super) fn load(path: &Path, node: &str, animation: Option<&str>) -> Result<GltfTrack> {
    track(&mut Document::open(path)?, node, animation)
}
