//! The scenes that are measured, as texts, and the files that they name.

use std::path::{Path, PathBuf};

use glam::DVec3;
use half::f16;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::{Overrides, parse};

/// Where the camera stands: distance from the centre in units of R, half-width of the image plane.
#[derive(Clone, Copy)]
pub struct Place {
    distance: f64,
    half_width: f64,
}

impl Place {
    /// Inside of meshes that are rooms.
    pub fn of(mesh: &str) -> Place {
        let (distance, half_width) = match mesh {
            "kitchen" | "room" => (0.3, 0.7),
            _ => (2.2, 0.5),
        };
        Place {
            distance,
            half_width,
        }
    }
}

/// What is rendered of a mesh.
pub struct Case {
    pub name: &'static str,
    pub moving: bool,
    pub light: Light,
}

pub enum Light {
    Base,
    Uv {
        filter: &'static str,
        line: bool,
    },
    Spectra,
    Capture,
    Pulse,
    Lamp {
        shadows: bool,
        matte: bool,
        count: u32,
    },
    Sky,
    Panorama,
}

/// The one that the others are compared with.
pub const HEADLINE: &str = "0.9c, cubic in time";

/// The same seen by a camera at rest.
pub const RESTING: &Case = &Case {
    name: "at rest, cubic in time",
    moving: false,
    light: Light::Uv {
        filter: "cubic",
        line: false,
    },
};

const fn cube(name: &'static str, filter: &'static str, line: bool) -> Case {
    Case {
        name,
        moving: true,
        light: Light::Uv { filter, line },
    }
}

const fn case(name: &'static str, moving: bool, light: Light) -> Case {
    Case {
        name,
        moving,
        light,
    }
}

const fn lamps(count: u32, shadows: bool, matte: bool) -> Light {
    Light::Lamp {
        shadows,
        matte,
        count,
    }
}

pub const CASES: &[Case] = &[
    case("at rest", false, Light::Base),
    case("0.9c", true, Light::Base),
    cube("0.9c, linear in time", "linear", false),
    cube(HEADLINE, "cubic", false),
    cube("0.9c, cubic in time, a line's colour", "cubic", true),
    case(
        "0.9c, cubic in time, colours as spectra",
        true,
        Light::Spectra,
    ),
    case("0.9c, projected capture", true, Light::Capture),
    case("0.9c, pulse with shadows", true, Light::Pulse),
    case("0.9c, lamp without shadows", true, lamps(1, false, false)),
    case("0.9c, lamp with shadows", true, lamps(1, true, false)),
    case(
        "0.9c, two lamps without shadows",
        true,
        lamps(2, false, false),
    ),
    case("0.9c, lamp on matte surfaces", true, lamps(1, false, true)),
    case(
        "0.9c, two lamps on matte surfaces",
        true,
        lamps(2, false, true),
    ),
    case("0.9c, gradient sky behind", true, Light::Sky),
    case("0.9c, panorama behind", true, Light::Panorama),
];

pub const MAIN_CASES: &[Case] = &[
    case("at rest", false, Light::Base),
    cube(HEADLINE, "cubic", false),
];

/// A camera whose rays leave each from an event of its own, to be compared with a point camera that
/// sees the same.
pub struct Camera {
    pub name: &'static str,
    tables: &'static [&'static str],
    /// Other than a rigid body. Its focal length is γ times longer in its own frame, and its film wider.
    assembly: Option<&'static str>,
}

const fn lens(
    name: &'static str,
    tables: &'static [&'static str],
    assembly: Option<&'static str>,
) -> Camera {
    Camera {
        name,
        tables,
        assembly,
    }
}

impl Camera {
    /// The scene `text` of a point camera at 0.9 c with this camera in its place.
    pub fn in_place(&self, text: &str) -> String {
        let mut text = format!("{text}{}", self.tables.concat());
        if let Some(assembly) = self.assembly {
            text += &format!("assembly = \"{assembly}\"\n");
            let (before, rest) = text.split_once("hfov = \"").expect("a field of view");
            let (degrees, after) = rest.split_once(" deg").expect("degrees");
            let half = 0.5 * degrees.parse::<f64>().expect("a number").to_radians();
            let wide = 2.0 * (half.tan() / 0.19f64.sqrt()).atan();
            text = format!("{before}hfov = \"{} deg{after}", wide.to_degrees());
        }
        text
    }
}

const SENSOR: &str = "[camera.sensor]\nfocal_length = \"36 mm\"\n";
const ACCELERATION: &str =
    "[camera.motion]\nacceleration = { proper = \"0.1 /m\", direction = [0, 0, 1] }\n";
const ROTATION: &str = "[camera.rotation]\naxis = [0, 1, 0]\nrate = \"2 rad/m\"\n";
const SHUTTER: &str = "[camera.shutter]\nduration = \"1 mm\"\n";

pub const CAMERAS: &[Camera] = &[
    lens("sensor", &[SENSOR], None),
    lens("fixed length in the world", &[SENSOR], Some("world_length")),
    lens("accelerating sensor", &[ACCELERATION, SENSOR], None),
    lens("Bell's ships", &[ACCELERATION, SENSOR], Some("bell")),
    lens("turning sensor", &[ROTATION, SENSOR], None),
    lens("shutter", &[SHUTTER], None),
    lens("shutter and acceleration", &[ACCELERATION, SHUTTER], None),
];

/// The files of a mesh and its size.
pub struct Files {
    folder: PathBuf,
    centre: DVec3,
    radius: f64,
}

impl Files {
    /// For scenes that need none.
    pub fn none(folder: &Path) -> Files {
        Files {
            folder: folder.into(),
            centre: DVec3::ZERO,
            radius: 1.0,
        }
    }

    /// `mesh.glb` of `triangles`, with texture coordinates by x and y, of glTF's default material, which is a rough metal, and
    /// `matte.glb`; `cube.npy` and `sky.hdr`.
    pub fn write(folder: &Path, triangles: &[[DVec3; 3]], cube: [usize; 3]) -> Files {
        let points = || triangles.iter().flatten().copied();
        let lo = points().fold(DVec3::INFINITY, DVec3::min);
        let hi = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        for (name, metallic) in [("mesh.glb", 1), ("matte.glb", 0)] {
            let mesh = glb(triangles, lo, hi, metallic);
            std::fs::write(folder.join(name), mesh).expect("mesh");
        }
        std::fs::write(folder.join("cube.npy"), npy(cube)).expect("cube");
        write_panorama(folder);
        Files {
            folder: folder.into(),
            centre: (lo + hi) / 2.0,
            radius: (hi - lo).length() / 2.0,
        }
    }

    /// Parses, plans and prepares a scene beside these files.
    pub fn prepare(&self, text: &str) -> Prepared {
        self.prepare_as(text, &Overrides::default(), |_| Request::default())
    }

    /// The same at another size.
    pub fn prepare_at(&self, text: &str, size: [u32; 2], samples: u32) -> Prepared {
        let overrides = Overrides {
            size: Some(size),
            samples_per_pixel: Some(samples),
            ..Overrides::default()
        };
        self.prepare_as(text, &overrides, |_| Request::default())
    }

    /// The same where the memory lacks this part of its cube's bytes, or one byte, so that it is read in bricks; none of a cube that takes less
    /// than the least room for bricks.
    pub fn prepare_in_bricks(&self, text: &str, lacking: f64) -> Option<Prepared> {
        let cube = self.folder.join("cube.npy").metadata().expect("cube").len();
        (cube > MOST_ALWAYS_HELD).then(|| {
            let lacking = ((cube as f64 * lacking) as u64).max(1);
            self.prepare_as(text, &Overrides::default(), |plan| Request {
                memory_limit: plan.memory.total() - lacking,
                ..Request::default()
            })
        })
    }

    /// The same as is requested of its plan.
    fn prepare_as(
        &self,
        text: &str,
        overrides: &Overrides,
        request: impl Fn(&Plan) -> Request,
    ) -> Prepared {
        let scene = parse(text, "benchmark", &self.folder, overrides).expect("a scene");
        let plan = Plan::new(&scene, &Request::default()).expect("a plan");
        let plan = Plan::new(&scene, &request(&plan)).expect("a plan");
        Prepared::new(&scene, &plan, &Silent).expect("a prepared scene")
    }
}

/// Half of a cube of more bytes than this is more than the least room for bricks, 8 MiB.
const MOST_ALWAYS_HELD: u64 = 16 << 20;

/// Writes `sky.hdr`.
pub fn write_panorama(folder: &Path) {
    std::fs::write(folder.join("sky.hdr"), panorama(2048)).expect("sky");
}

/// A Radiance picture of all directions, this many texels wide.
fn panorama(width: usize) -> Vec<u8> {
    let height = width / 2;
    let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut texels = head.into_bytes();
    for at in 0..width * height {
        let [x, y] = [at % width, at / width].map(|k| (k % 128) as u8);
        texels.extend([128 + x, 128 + y, 255 - x, 128]);
    }
    texels
}

/// The scene of `case`.
pub fn of_mesh(files: &Files, case: &Case, place: Place, image: u32) -> String {
    let (c, r) = (files.centre, files.radius);
    let eye = c + DVec3::Z * (place.distance * r);
    let camera = camera(eye, place.half_width, case.moving, image);
    let source = source(&case.light, c, r, eye);
    let mesh = match case.light {
        Light::Lamp { matte: true, .. } => "matte.glb",
        _ => "mesh.glb",
    };
    format!("{camera}\n[[object]]\nname = \"mesh\"\ngltf = \"{mesh}\"\n{source}")
}

/// A camera that looks along −z; a moving one approaches at 0.9 c.
fn camera(eye: DVec3, half_width: f64, moving: bool, image: u32) -> String {
    let [x, y, z] = eye.to_array();
    let half = half_width.atan();
    // tan(θ′/2) = √((1 − β)/(1 + β)) tan(θ/2).
    let narrow = 2.0 * ((0.1f64 / 1.9).sqrt() * (0.5 * half).tan()).atan();
    let fov = 2.0 * if moving { narrow } else { half }.to_degrees();
    let beta = if moving { -0.9 } else { 0.0 };
    format!(
        "[display]\nback_faces = \"two_sided\"\nsamples_per_pixel = 1\n[camera]\neye = [{x}, {y}, {z}]\n\
         look_at = [{x}, {y}, {}]\nhfov = \"{fov} deg\"\nsize = [{image}, {image}]\n\
         velocity = {{ beta = [0, 0, {beta}] }}\n",
        z - 1.0
    )
}

/// Bins long enough for all light that reaches the eye at time 0, and all that a capture camera near it
/// records of such light.
fn source(light: &Light, c: DVec3, r: f64, eye: DVec3) -> String {
    let bins = |start: f64, width: f64| {
        format!(
            "[source.cube]\nfile = \"cube.npy\"\nstart = \"{start} m\"\nbin_width = \"{width} m\"\n"
        )
    };
    match light {
        Light::Base => String::new(),
        Light::Uv { filter, line } => {
            let quantity = "radiance = { quantity = \"line\", wavelength = \"900 nm\" }\n";
            let quantity = if *line { quantity } else { "" };
            let bins = bins(-3.4 * r, 3.5 * r / 64.0);
            format!("[[source]]\n{quantity}{bins}filter = \"{filter}\"\nuv = 0\n")
        }
        Light::Spectra => {
            let bins = bins(-3.4 * r, 3.5 * r / 64.0);
            format!(
                "[[source]]\nradiance = {{ quantity = \"rgb\" }}\n{bins}filter = \"cubic\"\nuv = 0\n"
            )
        }
        Light::Capture => {
            let bins = bins(-1.7 * r, 3.4 * r / 64.0);
            let (e, c) = (eye + DVec3::splat(0.1 * r), c.to_array());
            let camera = format!(
                "{{ eye = {:?}, look_at = {c:?}, hfov = \"60 deg\" }}",
                e.to_array()
            );
            format!(
                "[[source]]\n{bins}clock = \"capture\"\nfilter = \"cubic\"\ncapture = {camera}\n"
            )
        }
        Light::Panorama => PANORAMA.1.into(),
        Light::Sky => "[sky]\ngradient = {}\nlights = false\n".into(),
        Light::Lamp { shadows, count, .. } => {
            let lamp = |k| {
                let lamp = (c + DVec3::new(0.5 - f64::from(k), 0.6, 0.4) * r).to_array();
                format!(
                    "[[light]]\nposition = {lamp:?}\nshadows = {shadows}\nvelocity = {{ beta = [0.3, 0, 0] }}\n"
                )
            };
            (0..*count).map(lamp).collect()
        }
        Light::Pulse => {
            let lamp = (c + DVec3::new(0.5, 0.6, 0.4) * r).to_array();
            format!(
                "[[source]]\npulse = {{ position = {lamp:?}, time = \"{} m\", sigma = \"{} m\", intensity = 1.0 }}\n",
                -3.0 * r,
                3.0 * r
            )
        }
    }
}

/// Skies that are seen, and light nothing. By default a scene has 5000 stars, up to magnitude 6; 14,000 are brighter than 7.
pub const SKIES: &[(&str, &str)] = &[
    ("nothing", "[sky]\nradiance = [0, 0, 0]\nlights = false\n"),
    PANORAMA,
    (
        "5000 stars",
        "[sky]\nstars = { count = 5000 }\nlights = false\n",
    ),
    (
        "14,000 stars",
        "[sky]\nstars = { count = 14000 }\nlights = false\n",
    ),
    (
        "100,000 stars",
        "[sky]\nstars = { count = 100000 }\nlights = false\n",
    ),
];

const PANORAMA: (&str, &str) = (
    "panorama",
    "[sky]\nimage = { file = \"sky.hdr\" }\nlights = false\n",
);

/// A projection at 0.9 c in the direction of its middle, its field of view in degrees, and columns per row.
pub const VIEWS: &[(&str, u32, u32)] = &[
    ("perspective", 60, 1),
    ("equirectangular", 360, 2),
    ("fisheye_equidistant", 180, 1),
];

/// `sky` as such a camera sees it.
pub fn of_sky((projection, degrees, columns): (&str, u32, u32), sky: &str, width: u32) -> String {
    let size = [width, width / columns];
    format!(
        "[display]\nsamples_per_pixel = 1\n[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\n\
         projection = \"{projection}\"\nhfov = \"{degrees} deg\"\nsize = {size:?}\nvelocity = {{ beta = [0, 0, -0.9] }}\n{sky}"
    )
}

/// Sixteen spheres in front of a camera at rest, at as many different velocities as `frames` says.
pub fn spheres(frames: usize, image: u32) -> String {
    let mut text = camera(DVec3::new(0.0, 0.0, 8.0), 0.5, false, image);
    for i in 0..16 {
        let (x, y) = ((i % 4) as f64 * 2.0 - 3.0, (i / 4) as f64 * 2.0 - 3.0);
        // Every light path from here to the camera is about 8.5 m long.
        let beta = 0.05 * (i % frames + 1) as f64;
        text += &format!(
            "[[object]]\nname = \"ball {i}\"\nshape = {{ sphere = {{ radius = 0.8, subdivisions = 5 }} }}\n\
             velocity = {{ beta = [0, {beta}, 0] }}\norigin = {{ position = [{x}, {y}, 0], time = \"-8.5 m\" }}\n"
        );
    }
    text
}

/// A binary glTF file of unindexed triangles, texture coordinates 0 to 1 over x and y, of a rough material.
fn glb(triangles: &[[DVec3; 3]], lo: DVec3, hi: DVec3, metallic: u32) -> Vec<u8> {
    let count = 3 * triangles.len();
    let points = || triangles.iter().flatten();
    let uv = |p: &DVec3| {
        let at = (*p - lo) / (hi - lo);
        [at.x as f32, 1.0 - at.y as f32]
    };
    let positions = points().flat_map(|p| p.as_vec3().to_array());
    let numbers = positions.chain(points().flat_map(uv));
    let data: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let json = serde_json::json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": metallic, "roughnessFactor": 1 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "buffers": [{ "byteLength": data.len() }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 12 * count },
            { "buffer": 0, "byteOffset": 12 * count, "byteLength": 8 * count },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
              "min": lo.as_vec3().to_array(), "max": hi.as_vec3().to_array() },
            { "bufferView": 1, "componentType": 5126, "count": count, "type": "VEC2" },
        ],
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + data.len();
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    let word = |file: &mut Vec<u8>, n: usize| file.extend((n as u32).to_le_bytes());
    word(&mut file, 2);
    word(&mut file, length);
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", data)] {
        word(&mut file, chunk.len());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// A smooth RGB cube of half floats.
fn npy([rows, columns, bins]: [usize; 3]) -> Vec<u8> {
    let header = format!(
        "{{'descr': '<f2', 'fortran_order': False, 'shape': ({rows}, {columns}, {bins}, 3), }}"
    );
    let header = format!("{header:<117}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.into_bytes());
    for i in 0..rows * columns * bins * 3 {
        let value = ((i % 97) * (i / 193 % 89)) as f32 / 8633.0;
        file.extend(f16::from_f32(value).to_le_bytes());
    }
    file
}

/// Each triangle in four, by the midpoints of its edges.
pub fn split(triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    let four = |&[a, b, c]: &[DVec3; 3]| {
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(four).collect()
}
