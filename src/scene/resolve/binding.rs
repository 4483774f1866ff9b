//! The surfaces that a source is bound to. A surface has its radiance from one cube by texture coordinates, from any number of captures
//! or pulses, or else its base colour.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::context::Context;
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{Binding, Object};
use crate::scene::suggest::did_you_mean;
use crate::spacetime::units::quoted;

/// Surfaces (objects × materials) that sources may be bound to, in total.
const MOST_SURFACES: usize = 1 << 20;

/// The surfaces bound so far.
pub(super) struct Bindings<'a> {
    cx: &'a Context,
    objects: &'a [Object],
    index: HashMap<&'a str, usize>,
    /// By object, claims of all its surfaces. The claims on one object share its surfaces, so they are of one kind: the latest represents
    /// all.
    whole: HashMap<usize, Claim>,
    /// By object and kind, claims of some of its surfaces: different surfaces may have different kinds.
    partly: HashMap<(usize, Kind), Claim>,
    /// By object and material.
    surfaces: HashMap<(usize, &'a str), Claim>,
    /// The number of surfaces that all sources have named.
    claimed: usize,
}

/// The place for messages: the name, or its substitute.
pub(super) fn span(at: &At<file::Source>) -> Range<usize> {
    let source = &at.value;
    let name = source.name.as_ref();
    let file = source.cube.as_ref().map(|cube| &cube.value.file);
    let pulse = || source.pulse.as_ref().map(|pulse| pulse.span.clone());
    let span = name.or(file).map(|text| text.span.clone()).or_else(pulse);
    span.unwrap_or_else(|| at.span.clone())
}

/// A source that claims a surface.
#[derive(Debug, Clone)]
struct Claim {
    span: Range<usize>,
    kind: Kind,
}

/// With which other sources a source may share a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kind {
    /// With nothing.
    Texture,
    /// With captures.
    Capture,
    /// With pulses.
    Pulse,
}

impl Claim {
    fn excludes(&self, other: &Claim) -> bool {
        self.kind == Kind::Texture || self.kind != other.kind
    }
}

fn kind(source: &file::Source) -> Kind {
    match &source.cube {
        Some(cube) if cube.value.capture.is_some() => Kind::Capture,
        Some(_) => Kind::Texture,
        None => Kind::Pulse,
    }
}

impl<'a> Bindings<'a> {
    pub fn new(cx: &'a Context, objects: &'a [Object]) -> Self {
        let named = objects.iter().enumerate();
        Bindings {
            cx,
            objects,
            index: named.map(|(i, object)| (object.name.as_str(), i)).collect(),
            whole: HashMap::new(),
            partly: HashMap::new(),
            surfaces: HashMap::new(),
            claimed: 0,
        }
    }

    /// The binding of a source; refused if it names something that does not exist, or shares a surface that it must not share.
    pub fn bind(&mut self, at: &'a At<file::Source>) -> Result<Binding> {
        let objects = self.objects_of(at)?;
        let materials = self.materials_of(at)?;
        let all = objects.is_none() && materials.is_empty();
        let bound = objects.unwrap_or_else(|| (0..self.objects.len()).collect());
        self.refuse_two_frames(at, &bound)?;
        self.claim(at, &bound, &materials)?;
        Ok(match all {
            true => Binding::All,
            false => Binding::Only {
                objects: bound,
                materials: materials.into_iter().map(str::to_string).collect(),
            },
        })
    }

    /// The named objects, ascending; `None` for all.
    fn objects_of(&self, at: &At<file::Source>) -> Result<Option<Vec<usize>>> {
        let Some(names) = &at.value.objects else {
            return Ok(None);
        };
        self.refuse_empty_or_repeated(names, "object")?;
        let find = |name: &At<String>| {
            let index = self.index.get(name.value.as_str()).copied();
            index.ok_or_else(|| self.unknown_object(name))
        };
        let mut indices: Vec<usize> = names.value.iter().map(find).collect::<Result<_>>()?;
        indices.sort_unstable();
        Ok(Some(indices))
    }

    fn unknown_object(&self, name: &At<String>) -> crate::Error {
        let names = self.objects.iter().map(|object| object.name.as_str());
        let meant = did_you_mean(&name.value, names.clone(), quoted);
        let known: Vec<String> = names.take(12).map(quoted).collect();
        let what = format!("there is no object named {}", quoted(&name.value));
        let known = known.join(", ");
        self.cx
            .refuse(name, what, format!("{meant}the objects are: {known}"))
    }

    /// The named materials; empty for all. Whether the files contain them is checked once those are read.
    fn materials_of(&self, at: &'a At<file::Source>) -> Result<Vec<&'a str>> {
        let Some(names) = &at.value.materials else {
            return Ok(Vec::new());
        };
        self.refuse_empty_or_repeated(names, "material")?;
        Ok(names.value.iter().map(|name| name.value.as_str()).collect())
    }

    fn refuse_empty_or_repeated(&self, names: &At<Vec<At<String>>>, thing: &str) -> Result<()> {
        if names.value.is_empty() {
            let what = format!("the list of {thing}s is empty: this source would light nothing");
            let help = format!("name {thing}s, or leave the key out for all");
            return Err(self.cx.refuse(names, what, help));
        }
        let mut seen = HashSet::new();
        match names.value.iter().find(|name| !seen.insert(&name.value)) {
            None => Ok(()),
            Some(twice) => {
                let what = format!("{} is named twice", quoted(&twice.value));
                Err(self
                    .cx
                    .refuse(twice, what, format!("name each {thing} once")))
            }
        }
    }

    /// A capture camera must rest in the frame of what it captured, and is positioned in its coordinates.
    fn refuse_two_frames(&self, at: &At<file::Source>, bound: &[usize]) -> Result<()> {
        let cube = at.value.cube.as_ref();
        let capture = cube.and_then(|cube| cube.value.capture.as_ref());
        let mut objects = bound.iter().filter_map(|&i| self.objects.get(i));
        let (Some(capture), Some(first)) = (capture, objects.next()) else {
            return Ok(());
        };
        // Objects at rest share the coordinates of the world, wherever their origins are.
        let same_frame = |object: &&Object| {
            let at_rest = object.velocity.is_rest() && first.velocity.is_rest();
            at_rest || (object.velocity == first.velocity && object.origin == first.origin)
        };
        let Some(other) = objects.find(|object| !same_frame(object)) else {
            return Ok(());
        };
        let (a, b) = (quoted(&first.name), quoted(&other.name));
        let what = format!(
            "one capture camera cannot be at rest in the frames of both {a} and {b}, which differ in \
             velocity or origin"
        );
        let help = "give the source `objects` that share one frame, and each frame its own source";
        Err(self.cx.refuse(capture, what, help))
    }

    /// Claims the surfaces for this source.
    fn claim(
        &mut self,
        at: &At<file::Source>,
        bound: &[usize],
        materials: &[&'a str],
    ) -> Result<()> {
        let here = Claim {
            span: span(at),
            kind: kind(&at.value),
        };
        // A scene of a few kilobytes could name billions of pairs.
        self.claimed += bound.len().saturating_mul(materials.len().max(1));
        if self.claimed > MOST_SURFACES {
            let what = "the sources name too many surfaces (objects × materials)";
            let help = format!("name at most {MOST_SURFACES} in all");
            return Err(self.cx.report.refuse(&here.span, what, help));
        }
        for &object in bound {
            let taken = match materials.is_empty() {
                true => self.claim_whole(object, &here),
                false => self.claim_materials(object, materials, &here),
            };
            if let Some(other) = taken {
                return Err(self.taken(&here.span, &other.span, object));
            }
        }
        Ok(())
    }

    /// The source that already has part of the object, if any.
    fn claim_whole(&mut self, object: usize, here: &Claim) -> Option<Claim> {
        let kinds = [Kind::Texture, Kind::Capture, Kind::Pulse].into_iter();
        let partly = kinds.filter_map(|kind| self.partly.get(&(object, kind)));
        let taken = self
            .whole
            .get(&object)
            .into_iter()
            .chain(partly)
            .find(|other| other.excludes(here))
            .cloned();
        self.whole.insert(object, here.clone());
        taken
    }

    fn claim_materials(
        &mut self,
        object: usize,
        materials: &[&'a str],
        here: &Claim,
    ) -> Option<Claim> {
        self.partly.insert((object, here.kind), here.clone());
        let whole = self.whole.get(&object).cloned();
        let claimed = materials.iter().take(MOST_SURFACES + 1);
        let mut earlier = claimed.map(|name| self.surfaces.insert((object, name), here.clone()));
        whole
            .filter(|other| other.excludes(here))
            .or_else(|| earlier.find_map(|taken| taken.filter(|other| other.excludes(here))))
    }

    fn taken(&self, here: &Range<usize>, other: &Range<usize>, object: usize) -> crate::Error {
        let name = self.objects.get(object).map_or("", |object| &object.name);
        let what = format!(
            "two sources are bound to the same surface of {}",
            quoted(name)
        );
        let help = "a surface has its radiance from one cube, or from cubes that all have a `capture` camera, or reflects pulses: separate the sources by `objects` or `materials`";
        let other = (other, "the other source");
        self.cx.report.refuse_two(here, other, what, help)
    }
}
