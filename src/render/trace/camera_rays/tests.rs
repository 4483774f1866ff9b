use std::f64::consts::PI;

use super::*;
use crate::camera::Camera;
use crate::scene::model::{
    Assembly, CameraModel, Equations, Motion, ProjectionKind, Rotation, Sensor, Shutter,
};
use crate::spacetime::Velocity;

/// The view of a camera at this speed, with what `set` sets.
fn view(beta: f64, aberration: bool, set: impl Fn(&mut CameraModel)) -> AnyView {
    let eye = DVec3::new(1.0, 2.0, 3.0);
    let mut camera = CameraModel::looking(DVec3::new(-1.0, -1.5, -4.0), eye, [90, 70]);
    camera.velocity = Velocity::from_beta(DVec3::Y * beta).unwrap();
    set(&mut camera);
    let camera = Camera::of(&camera, Equations::default(), aberration, "camera");
    camera.unwrap().view
}

#[test]
fn rays_of_a_tile_are_those_of_their_film_points_bit_for_bit() {
    let point = |_: &mut CameraModel| {};
    let fisheye = |camera: &mut CameraModel| {
        camera.projection = ProjectionKind::FisheyeEquidistant;
        camera.horizontal_fov = PI;
    };
    let lens = |assembly| {
        move |camera: &mut CameraModel| {
            camera.sensor = Some(Sensor {
                focal_length: 0.1,
                assembly,
            })
        }
    };
    let [sensor, stretched, pair] =
        [Assembly::Rigid, Assembly::WorldLength, Assembly::Bell].map(lens);
    let shutter = |camera: &mut CameraModel| {
        camera.shutter = Some(Shutter {
            duration: 0.3,
            records: Default::default(),
            integration: Default::default(),
        })
    };
    let turn = |camera: &mut CameraModel| {
        camera.rotation = Some(Rotation {
            axis: DVec3::Y,
            rate: 0.2,
            through: Default::default(),
            elements: Default::default(),
        })
    };
    let push = |camera: &mut CameraModel| camera.motion = Motion::Accelerated(DVec3::Z * 0.1);
    let views = [
        view(0.0, true, point),
        view(0.9, true, point),
        view(-0.999_999, true, point),
        view(0.5, true, fisheye),
        view(0.9, true, sensor),
        view(0.0, true, sensor),
        view(0.9, true, stretched),
        view(0.9, true, shutter),
        view(0.9, false, shutter),
        view(0.9, true, |c| (push(c), sensor(c)).0),
        view(0.9, false, |c| (push(c), sensor(c)).0),
        view(0.9, true, |c| (push(c), pair(c)).0),
        view(0.9, false, |c| (push(c), pair(c)).0),
        view(0.9, true, |c| (push(c), shutter(c)).0),
        view(0.9, false, |c| (push(c), shutter(c)).0),
        view(0.9, true, |c| (turn(c), sensor(c)).0),
        view(0.0, false, |c| (turn(c), sensor(c)).0),
        view(0.5, true, |c| (turn(c), shutter(c)).0),
    ];
    let count = |is: fn(&AnyView) -> bool| views.iter().filter(|view| is(view)).count();
    assert_eq!(count(|view| matches!(view, AnyView::Inertial(_))), 5);
    assert_eq!(count(|view| matches!(view, AnyView::Accelerated(_))), 6);
    assert_eq!(count(|view| matches!(view, AnyView::Turning(_))), 3);
    for (number, view) in views.iter().enumerate() {
        for (samples, size) in [(1, [16, 16]), (4, [16, 16]), (3, [7, 11]), (1, [1, 1])] {
            let corner = [64, 48];
            let (tile, sampler) = (Tile { corner, size }, Sampler::stratified(samples));
            let mut rays = CameraRays::default();
            generator(view).generate(&mut rays, &sampler, tile, 0..samples);
            let pixels = || tile.coordinates();
            let all = (0..samples).flat_map(|sample| pixels().map(move |at| (sample, at)));
            let mut count = 0;
            for (k, (sample, (column, row))) in all.enumerate() {
                let [x, y] = sampler.offset(column, row, sample);
                let moment = rays.moments.get(k).copied().unwrap_or(0.5);
                let alone = view.ray(f64::from(column) + x, f64::from(row) + y, moment);
                let origin = rays.origins.get(k).copied().unwrap_or(RayOrigin::AT_SHOT);
                let bits = |d: DVec3, w: f64, from: RayOrigin| {
                    let (ct, at) = (from.displacement.ct, from.displacement.x);
                    let numbers = [d.x, d.y, d.z, w, ct, at.x, at.y, at.z];
                    (numbers.map(f64::to_bits), from.delay, from.weight)
                };
                let together = bits(rays.directions[k], rays.ratios[k], origin);
                let alone = bits(alone.d.unit(), alone.ratio, alone.origin);
                assert_eq!(together, alone, "view {number}, {samples}: {column} {row}");
                count += 1;
            }
            assert_eq!(rays.directions.len(), count);
            // The same rays in another order.
            let mut by_pixel = CameraRays::default();
            let generator = generator(view);
            generator.place_by_pixel(&mut by_pixel, &sampler, tile, 0..samples);
            generator.look(&mut by_pixel);
            assert_eq!(by_pixel.directions.len(), count);
            for k in 0..count {
                let (pixel, sample) = (k / samples as usize, k % samples as usize);
                let of = sample * tile.pixels() + pixel;
                let bits = |rays: &CameraRays, k: usize| {
                    let moment = rays.moments.get(k).copied();
                    let [x, y] = rays.offset(k);
                    let d = rays.directions[k];
                    let numbers = [d.x, d.y, d.z, rays.ratios[k], x, y];
                    (numbers.map(f64::to_bits), moment, rays.pixels[k])
                };
                assert_eq!(bits(&by_pixel, k), bits(&rays, of), "view {number}: {k}");
                assert_eq!(by_pixel.origin(k), rays.origin(of));
            }
        }
    }
}
