//! The scene in the words of the bundle.

use glam::DVec3;

use super::bundle::{
    CameraEntry, ChannelEntry, FourVector, LightEntry, MappingEntry, Matrix, ObjectEntry,
    PartEntry, PulseEntry, Radiometry, RotationEntry, SceneEntry, SensorEntry, ShutterEntry,
    VelocityEntry,
};
use crate::camera::{Camera, Projection, ViewKind};
use crate::io::gltf::glb::Run;
use crate::mesh::{AlphaMode, Mesh};
use crate::render::aov::{Aov, Combine};
use crate::render::metadata;
use crate::render::plan::{Lit, shown_by};
use crate::render::prepare::scaling;
use crate::scene::model::{CubeBacks, Mapping, Object, ProjectionKind, Pulse, Scene, Sensor};
use crate::spacetime::{Boost, Displacement, Frame, Quantity, Velocity, World};

/// The properties of `scene`, whose text is in `text`; `undescribed` lists the light that is not in the bundle.
pub(super) fn scene(
    scene: &Scene,
    text: &'static str,
    undescribed: Vec<&'static str>,
) -> SceneEntry {
    SceneEntry {
        name: scene.name.clone(),
        text,
        speed_of_light_m_per_s: scene.speed_of_light,
        medium_index: scene.medium_index,
        ray_index: if scene.effects.retardation {
            scene.medium_index
        } else {
            0.0
        },
        equations: scene.equations,
        effects: scene.effects,
        back_faces: scene.back_faces,
        background: scene.background,
        base_colour: radiometry(scene, scene.quantity),
        is_lit: scene.is_lit(),
        undescribed,
        outside: scene.outside,
        captures: scene.captures,
        samples_per_pixel: scene.samples_per_pixel,
    }
}

/// The camera of `scene`, which takes its picture as `camera`.
pub(super) fn camera(scene: &Scene, camera: &Camera) -> CameraEntry {
    let model = &scene.camera;
    let film = &camera.shot.projection;
    let [width, height] = film.size();
    let velocity = camera.shot.frame.velocity();
    // Right and up from film points for a perspective, from the axes for other projections.
    let from_middle = |x, y| film.vector(x, y) - film.vector(0.5 * width, 0.5 * height);
    let right_and_up = [
        from_middle(width, 0.5 * height),
        from_middle(0.5 * width, 0.0),
    ];
    let [right, up] = match model.projection == ProjectionKind::Perspective {
        true => right_and_up.map(|v| v.normalize().to_array()),
        false => [0, 1].map(|axis| film.axes()[axis].to_array()),
    };
    let kind = camera.view.kind();
    CameraEntry {
        kind,
        is_point: matches!(
            kind,
            ViewKind::Still | ViewKind::Moving | ViewKind::Unaberrated
        ),
        size: model.size,
        horizontal_fov_rad: camera.horizontal_fov(model),
        projection: model.projection,
        tan_half_fov: camera.tan_half_fov(),
        right,
        up,
        forward: film.forward().to_array(),
        shot_event: camera.shot.event.to_array(),
        time: model.time,
        clock_zero_event: model.origin.to_array(),
        velocity: self::velocity(velocity),
        world_from_camera: matrix(camera.shot.frame.world_from_frame()),
        motion: metadata::motion(&model.motion),
        sensor: model.sensor.map(|s| sensor(scene, s, camera)),
        rotation: model.rotation.map(|r| RotationEntry {
            axis: r.axis.to_array(),
            rate_rad_per_m: r.rate,
            through: r.through,
            elements: r.elements,
        }),
        shutter: model.shutter.map(|s| ShutterEntry {
            duration: s.duration,
            records: s.records,
        }),
    }
}

fn sensor(scene: &Scene, sensor: Sensor, camera: &Camera) -> SensorEntry {
    let half = scene.camera.sensor_half_size().unwrap_or_default();
    SensorEntry {
        focal_length: sensor.focal_length,
        own_focal_length: camera.own_focal_length(&sensor),
        size: half.map(|x| 2.0 * x),
        assembly: sensor.assembly,
    }
}

/// Object `index` of `scene`, with `mesh` in files of these names.
pub(super) fn object(
    scene: &Scene,
    index: usize,
    mesh: &Mesh,
    runs: &[Run],
    [geometry, positions]: [Option<String>; 2],
) -> ObjectEntry {
    let object: &Object = &scene.objects[index];
    ObjectEntry {
        name: object.name.clone(),
        geometry: geometry.unwrap_or_default(),
        positions,
        vertices: mesh.positions.len() as u64,
        triangles: mesh.triangles.len() as u64,
        velocity: velocity(object.velocity),
        origin: object.origin.to_array(),
        world_from_object: matrix(object.frame().world_from_frame()),
        parts: runs
            .iter()
            .map(|run| part(scene, index, mesh, run))
            .collect(),
    }
}

fn part(scene: &Scene, object: usize, mesh: &Mesh, run: &Run) -> PartEntry {
    let material = &mesh.materials[run.material as usize];
    let (radiance, sources) = match shown_by(scene, object, (&material.name, material.unlit)) {
        Lit::Base => ("base_colour", Vec::new()),
        Lit::Spectrum => ("spectrum", Vec::new()),
        Lit::Cube(source) => ("cube", vec![source]),
        Lit::Captures(sources) => ("captures", sources),
        Lit::Reflecting(sources) => ("pulses", sources),
    };
    PartEntry {
        first_triangle: run.first,
        triangles: run.count,
        material: material.name.clone(),
        base_colour: material.base_colour,
        has_texture: material.base_colour_texture.is_some(),
        has_vertex_colours: !mesh.colours.is_empty(),
        alpha_cutoff: match material.alpha_mode {
            AlphaMode::Mask { cutoff } => Some(cutoff),
            AlphaMode::Opaque | AlphaMode::Blend => None,
        },
        double_sided: material.double_sided,
        uv_sets: run.uv_sets.clone(),
        radiance,
        sources,
    }
}

/// What radiance of `quantity` measures, and the power of W for the scene's observers.
pub(super) fn radiometry(scene: &Scene, quantity: Quantity) -> Radiometry {
    Radiometry {
        quantity: quantity.kind().name(),
        line_wavelength: quantity.line(),
        continuation: (quantity == Quantity::Rgb).then(|| scene.continuation.name()),
        exponent: match scene.effects.searchlight {
            true => scaling(quantity, scene.equations).exponent(),
            false => 0,
        },
    }
}

pub(super) fn pulse(pulse: &Pulse) -> LightEntry {
    LightEntry::Pulse(PulseEntry {
        event: pulse.origin.to_array(),
        sigma: pulse.sigma,
        intensity: pulse.intensity,
        shadows: pulse.shadows,
    })
}

/// How surface points address a cube of shape `shape`.
pub(super) fn mapping(mapping: &Mapping, shape: [usize; 4]) -> MappingEntry {
    match mapping {
        Mapping::Uv { set, backs } => MappingEntry::Uv {
            set: *set,
            backs: (*backs != CubeBacks::AsFront).then_some(*backs),
        },
        Mapping::Capture(camera) => {
            let [right, up, forward] = camera.axes.map(|axis| axis.to_array());
            MappingEntry::Capture {
                eye: camera.eye.to_array(),
                right,
                up,
                forward,
                projection: camera.projection,
                horizontal_fov_rad: camera.horizontal_fov([shape[1], shape[0]]),
                film: camera.crop.map(|crop| crop.film),
                offset: camera.crop.map(|crop| crop.offset),
                near_clip: (camera.near_clip > 0.0).then_some(camera.near_clip),
            }
        }
    }
}

/// The radiance, and every auxiliary channel; the reference has those in `rendered`.
pub(super) fn channels(rendered: &[Aov]) -> Vec<ChannelEntry> {
    let radiance = ["radiance.R", "radiance.G", "radiance.B"].map(|name| ChannelEntry {
        name,
        meaning: "observed radiance, linear (R, G and B in EXR files; one array radiance in npz files)",
        definition: "W⁻ᵖ times the radiance that leaves the surface at E towards the camera",
        no_hit: Some("scene.background"),
        in_reference: !rendered.is_empty(),
    });
    let auxiliary = Aov::ALL.iter().map(|aov| ChannelEntry {
        name: aov.name(),
        meaning: aov.meaning(),
        definition: aov.definition(),
        no_hit: missing(*aov),
        in_reference: rendered.contains(aov),
    });
    radiance.into_iter().chain(auxiliary).collect()
}

fn missing(aov: Aov) -> Option<&'static str> {
    match aov.combine() {
        Combine::NearestIdentity => Some("-1"),
        Combine::Nearest | Combine::MeanOfHits => Some("NaN"),
        Combine::MeanOfAll | Combine::MeanOfSeeing | Combine::Coverage | Combine::Missing(_) => {
            None
        }
        Combine::StandardError | Combine::Samples => None,
    }
}

pub(super) fn velocity(velocity: Velocity) -> VelocityEntry {
    VelocityEntry {
        rapidity: velocity.rapidity().to_array(),
        beta: velocity.beta().to_array(),
        gamma: velocity.gamma(),
    }
}

/// The columns are the images of the unit vectors.
pub(super) fn matrix<F: Frame>(boost: &Boost<World, F>) -> Matrix {
    let unit = |i: usize| {
        let mut e = [0.0; 4];
        e[i] = 1.0;
        let [ct, x, y, z] = e;
        let d = boost.displacement(Displacement::new(ct, DVec3::new(x, y, z)));
        [d.ct, d.x.x, d.x.y, d.x.z]
    };
    let columns: [FourVector; 4] = std::array::from_fn(unit);
    std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row]))
}
