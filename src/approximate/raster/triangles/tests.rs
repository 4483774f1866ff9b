use super::super::cull::ScreenBounds;
use super::*;
use crate::accel::pages::Pages;
use crate::accel::{Bvh, numbers};
use crate::camera::Camera;
use crate::mesh::{Shape, shapes};
use crate::render::progress::Silent;
use crate::render::sampler::Sampler;
use crate::scene::model::{CameraModel, Equations};
use crate::spacetime::{Event, InertialFrame, Velocity};

/// A box of one metre at the origin, moving at `beta` along y.
fn moving_box(beta: f64) -> RestFrame {
    let mesh = shapes::mesh(Shape::Box { size: [1.0; 3] }, [1.0; 3]);
    let corners = (0..mesh.triangles.len() as u32).map(|index| mesh.corners(index));
    let velocity = Velocity::from_beta(DVec3::Y * beta).unwrap();
    RestFrame {
        frame: InertialFrame::new(velocity, Event::new(0.0, DVec3::ZERO)),
        bvh: Bvh::build(corners.collect(), |_| Facing::FrontOnly),
        normals: Pages::default(),
        patches: vec![],
        meshes: [mesh].into(),
        vertices: Default::default(),
    }
}

/// Four boxes at four speeds, each of which would be cut at less than eight times the allowed number of points.
#[test]
fn what_is_too_much_in_all_frames_together_is_begun_in_none() {
    let frames = [-0.3, -0.1, 0.1, 0.3].map(moving_box);
    let camera = CameraModel::looking(DVec3::NEG_Z, DVec3::Z * 4.0, [16, 16]);
    let camera = Camera::of(&camera, Equations::default(), true, "boxes").unwrap();
    let observer = Observer::of(&camera, 1.0).unwrap();
    let projections = frames
        .iter()
        .map(|f| observer.projection(&f.frame).unwrap());
    let projections: Vec<_> = projections.collect();
    let frusta: Vec<_> = projections.iter().map(Frustum::of).collect();
    let seen = frames.iter().zip(&projections);
    let seen: Vec<_> =
        (seen.map(|(f, p)| transformed(p, f.shared_vertices(), Straight::NEVER))).collect();

    // Each box alone is tried, and refused because of its cuts; all together are refused because of the forecast.
    let divide = |chosen: Range<usize>| {
        let cuts = Cuts::within(10_000 * Cuts::BYTES);
        let dividers = chosen.clone().map(|frame| Divider {
            projection: &projections[frame],
            frustum: &frusta[frame],
            tessellation: Tessellation::Uniform(0.01),
            vertices: FrameVertices {
                shared: frames[frame].shared_vertices(),
                apparent: &seen[frame],
            },
            cuts: &cuts,
            samples: None,
        });
        let dividers: Vec<_> = dividers.collect();
        let refused = divided(&frames[chosen], &dividers, &cuts, [16, 16], &Silent).is_err();
        (refused, cuts.are_too_many())
    };
    for frame in 0..4 {
        assert_eq!(divide(frame..frame + 1), (true, true));
    }
    assert_eq!(divide(0..4), (true, false));
}

#[test]
fn triangles_smaller_than_a_pixel_are_left_out_if_they_contain_no_sample() {
    let sampler = Sampler::stratified(1);
    let samples = SoleSamples::new(&sampler, [37, 23]);
    let pixels = (0..23).flat_map(|row| (0..37).map(move |column| (column, row)));
    let points = pixels.map(|(column, row)| {
        let [x, y] = sampler.offset(column, row, 0);
        [f64::from(column) + x, f64::from(row) + y]
    });
    let points: Vec<_> = points.collect();
    let mut random = numbers(1);
    let mut counts = [0; 2];
    for _ in 0..4000 {
        let [left, top] = [18.5 * (1.0 + random()), 11.5 * (1.0 + random())];
        let [right, bottom] = [(left, 37.0), (top, 23.0)]
            .map(|(from, end)| f64::min(from + 0.5 * (1.0 + random()), end));
        let is_inside =
            |[x, y]: &[f64; 2]| (left..=right).contains(x) && (top..=bottom).contains(y);
        let holds = points.iter().any(is_inside);
        let reach = ScreenBounds([left, top, right, bottom].map(|x| x as f32));
        assert_eq!(samples.miss(reach), !holds, "{reach:?}");
        counts[usize::from(holds)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 500), "{counts:?}");
}

#[test]
fn hits_tell_what_radiance_or_a_channel_depends_on() {
    let [by_fragment, by_vertex] = [Attributes::Fragment, Attributes::Vertex];
    for dependence in [Dependence::Patch, Dependence::Event] {
        assert_eq!(needed(dependence, false, by_fragment), dependence);
        assert_eq!(needed(dependence, true, by_fragment), Dependence::Weights);
        assert_eq!(needed(dependence, false, by_vertex), Dependence::Weights);
    }
}
