//! A scene to plant bugs in, and queries on the pictures.

use nullray::approximate::raster;
use nullray::io::image::{Layers, Samples};
use nullray::render::aov::{self, Aov};
use nullray::render::metadata::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture, compare};

/// A camera with β = 0.5 along x, a floor at rest and two boxes that move, of three colours.
pub const SCENE: &str = r#"
    camera = { eye = [0, 0.6, 4], look_at = [1.5, 0.3, 0], hfov = "60 deg", size = [96, 72], velocity = { beta = [0.5, 0, 0] } }
    [[object]]
    name = "floor"
    shape = { plane = { size = [12, 12] } }
    colour = [0.2, 0.5, 0.8]
    [[object]]
    name = "left"
    shape = { box = { size = [1.2, 1.2, 1.2] } }
    colour = [0.9, 0.6, 0.1]
    velocity = { beta = [0.3, 0, 0] }
    origin = { position = [-1, 0.6, 0], time = "-4 m" }
    [[object]]
    name = "right"
    shape = { box = { size = [1.2, 1.2, 1.2] } }
    colour = [0.3, 0.7, 0.5]
    velocity = { beta = [-0.4, 0, 0] }
    origin = { position = [1, 0.6, 0], time = "-4 m" }
"#;

pub fn parsed(text: &str) -> Scene {
    scene::parse(text, "test scene", ".".as_ref(), &Overrides::default()).unwrap()
}

/// What `scene` looks like at the centres of pixels, with all channels and metadata.
pub fn shot(scene: &Scene) -> Picture {
    taken(scene, true)
}

/// What `scene` looks like, at the centres of pixels or with samples all over them.
pub fn taken(scene: &Scene, pixel_centers: bool) -> Picture {
    let mut aovs = aov::parse("all").unwrap();
    aovs.retain(|aov| *aov != Aov::StandardError);
    let request = Request {
        aovs: aovs.clone(),
        pixel_centers,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    let film = render(&Prepared::new(scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    let [width, height] = film.size();
    let layers = Layers::new(
        width,
        height,
        film.channels(&aovs),
        metadata(scene, &film).unwrap(),
    );
    Picture::linear("picture", layers.unwrap())
}

/// The scene's picture after replacements in its text.
pub fn with(replaced: &[(&str, &str)]) -> Picture {
    let text = replaced.iter().fold(SCENE.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    shot(&parsed(&text))
}

pub fn exact() -> Picture {
    with(&[])
}

/// The picture without what it says of its scene, so that places are searched.
pub fn unknown(picture: &Picture) -> Picture {
    let mut picture = picture.clone();
    picture
        .layers
        .metadata
        .retain(|(key, _)| key != "scene_text");
    picture
}

/// The picture with these channels alone.
pub fn only(picture: &Picture, groups: &[&str]) -> Picture {
    let mut picture = picture.clone();
    picture.layers.channels.retain(|channel| {
        groups
            .iter()
            .any(|group| channel.name == *group || channel.name.starts_with(&format!("{group}.")))
    });
    picture
}

pub fn map(picture: &mut Picture, name: &str, of: impl Fn(usize, f64) -> f64) {
    let channel = picture.layers.channels.iter_mut().find(|c| c.name == name);
    let channel = channel.unwrap_or_else(|| panic!("no channel {name}"));
    let values = channel.samples.to_f64().into_iter().enumerate();
    channel.samples = Samples::F64(values.map(|(i, v)| of(i, v)).collect());
}

pub fn values(picture: &Picture, name: &str) -> Vec<f64> {
    picture.layers.channel(name).unwrap().samples.to_f64()
}

/// The exact picture with channels changed.
pub fn changed(names: &[&str], of: impl Fn(usize, f64) -> f64) -> Picture {
    let mut picture = exact();
    for name in names {
        map(&mut picture, name, &of);
    }
    picture
}

/// The picture whose pixel (x, y) holds what `source` says that of `picture` is.
pub fn rearranged(picture: &Picture, source: impl Fn(i64, i64) -> [i64; 2]) -> Picture {
    let [w, h] = [picture.layers.width, picture.layers.height].map(i64::from);
    let mut turned = picture.clone();
    for channel in &mut turned.layers.channels {
        let values = channel.samples.to_f64();
        let at = |i: i64| {
            let [x, y] = source(i % w, i / w);
            values[(y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize]
        };
        channel.samples = Samples::F64((0..w * h).map(at).collect());
    }
    turned
}

pub const LIGHT: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];

pub fn diagnosed_with(
    reference: &Picture,
    candidate: &Picture,
    options: &CompareOptions,
) -> Vec<Diagnosis> {
    compare(reference, candidate, options).unwrap().diagnoses
}

pub fn diagnosed(reference: &Picture, candidate: &Picture) -> Vec<Diagnosis> {
    let options = CompareOptions {
        bin_width: Some(0.05),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    diagnosed_with(reference, candidate, &options)
}

/// Asserts that one thing is named, of this kind and in these words.
pub fn named(kind: Kind, words: &[&str], found: &[Diagnosis]) {
    let kinds: Vec<_> = found.iter().map(|d| d.kind).collect();
    assert_eq!(kinds, [kind], "{found:?}");
    for word in words {
        assert!(found[0].what.contains(word), "{word:?}: {}", found[0].what);
    }
    assert!(!found[0].evidence.is_empty(), "{found:?}");
    assert!(
        found[0].evidence.iter().all(|(_, value)| value.is_finite()),
        "{found:?}"
    );
}

pub fn evidence(found: &[Diagnosis], name: &str) -> f64 {
    let mut evidence = found[0].evidence.iter();
    evidence
        .find(|(n, _)| *n == name)
        .unwrap_or_else(|| panic!("{found:?}"))
        .1
}

/// What a rasterizer makes of a scene, with all channels.
pub fn rasterized(scene: &Scene, method: &str) -> Picture {
    let mut aovs = aov::parse("all").unwrap();
    aovs.retain(|aov| *aov != Aov::StandardError);
    let request = Request {
        aovs: aovs.clone(),
        pixel_centers: true,
        ..Request::default()
    };
    let plan = Plan::new(scene, &request).unwrap();
    let prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    let method = method.parse::<raster::Method>().unwrap();
    let film = raster::render(&prepared, &method, &Silent).unwrap();
    let [w, h] = film.size();
    let layers = Layers::new(w, h, film.channels(&aovs), vec![]).unwrap();
    Picture::linear("raster", layers)
}
