//! Alpha masks of materials: surfaces with holes cut by a mask look like surfaces with holes in their triangles, to every ray and at any
//! velocity.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use nullray::mesh::{AlphaMode, Mesh};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::Builder;
use nullray::scene::model::Scene;
use serde_json::json;

use crate::pipeline::{files, stage};
use crate::raster;

/// Four columns of one row, of which the alpha of the two on the right is 0. The bilinear alpha is ½ halfway between.
fn half_there() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4, 1);
    encoder.set_color(png::ColorType::Rgba);
    let texel = |alpha: u8| [200, 200, 200, alpha];
    let texels = [255, 255, 0, 0].map(texel).concat();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&texels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A square of which the left half is there by its mask, and the same without a mask.
fn write(folder: &Path) {
    let image = half_there();
    let material = |masked: bool, emissive: [f64; 3]| {
        let mut material = json!({
            "name": "paint", "doubleSided": true, "emissiveFactor": emissive,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 },
        });
        if masked {
            material["alphaMode"] = "MASK".into();
        }
        material.to_string()
    };
    for (name, masked, emissive) in [
        ("masked.glb", true, [0.0; 3]),
        ("whole.glb", false, [0.0; 3]),
        ("masked-lamp.glb", true, [1.0; 3]),
        ("whole-lamp.glb", false, [1.0; 3]),
    ] {
        let material = material(masked, emissive);
        let quad = files::Quad {
            image: Some(&image),
            material: Some(&material),
            ..files::Quad::PLAIN
        };
        files::glb(&folder.join(name), &quad);
    }
}

/// A screen over a floor, its right half a hole: by the mask of its material, or because it is half as wide.
fn scene(folder: &Path, masked: bool, lamp: bool, keys: &str) -> Scene {
    let name = if lamp { "-lamp" } else { "" };
    let (file, narrow) = match masked {
        true => (format!("masked{name}.glb"), "scale = 1"),
        false => (
            format!("whole{name}.glb"),
            "scale = [0.5, 1, 1], translate = [-0.5, 0, 0]",
        ),
    };
    let text = format!(
        "{keys}\n[[object]]\nname = 'floor'\nshape = {{ plane = {{ size = [9, 9] }} }}\n\
         transform = {{ translate = [0, -1.5, 0] }}\nbody\n\
         [[object]]\nname = 'screen'\ngltf = '{file}'\ntransform = {{ {narrow} }}\nbody\n"
    );
    let motion = match keys.contains("beta") {
        true => "velocity = { beta = [0, 0.3, 0.4] }\norigin = { time = '-3 m' }",
        false => "",
    };
    stage::scene_in(folder, &text.replace("body", motion))
}

fn camera(more: &str) -> String {
    format!(
        "[camera]\neye = [0.4, 1.2, 4]\nlook_at = [0, -0.4, 0]\nhfov = '60 deg'\nsize = [40, 30]\n{more}\n"
    )
}

const SUN: &str = "[[light]]\ntype = 'directional'\ndirection = [0.4, -1, -0.5]\nirradiance = 3";

#[track_caller]
fn assert_same(masked: &Film, cut: &Film, what: &str) {
    let pairs = masked.radiance().iter().zip(cut.radiance());
    let worst = pairs.fold(0.0, |worst: f64, (a, b)| {
        (0..3).fold(worst, |worst, c| {
            worst.max((a[c] - b[c]).abs() / (1e-3 + b[c]))
        })
    });
    assert!(worst < 1e-9, "{what}: {worst:e}");
}

#[test]
fn camera_rays_shadows_and_bounces_pass_through_holes() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let still = camera("");
    let moving = camera("velocity = { beta = [0.3, 0, -0.2] }");
    let bounced = format!("{moving}[display]\nsamples_per_pixel = 16\n[render]\nbounces = 2");
    for keys in [still, moving.clone(), bounced] {
        let keys = format!("{keys}\n{SUN}\n[sky]\nradiance = 0.2");
        let film = |masked| {
            stage::rendered(
                &scene(folder.path(), masked, false, &keys),
                &stage::sampled(),
            )
            .unwrap()
        };
        let (masked, cut) = (film(true), film(false));
        assert_same(&masked, &cut, &keys);
        // Half of the screen hides some of the floor, and the other half does not.
        let seen = |film: &Film| {
            film.aov(Aov::Object)
                .unwrap()
                .iter()
                .filter(|o| **o == 1.0)
                .count()
        };
        assert!(seen(&masked) > 20, "{keys}: {}", seen(&masked));
        assert_eq!(seen(&masked), seen(&cut), "{keys}");
    }
}

#[test]
fn rasterizers_leave_holes_out_as_the_ray_tracer_does() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let keys = camera("velocity = { beta = [0.3, 0, -0.2] }");
    for method in [
        "raster:none",
        "raster:adaptive=0.1",
        "raster:none,attributes=vertex",
    ] {
        let film = |masked| {
            let scene = scene(folder.path(), masked, false, &keys);
            raster::stage::film(&raster::stage::centred(&scene), method)
        };
        let (masked, cut) = (film(true), film(false));
        // `none` bends the two differently, where it bends at all.
        if method == "raster:adaptive=0.1" {
            let other = raster::stage::different(&masked, &cut).len();
            assert!(other < 1200 / 50, "{method}: {other}");
        }
        let hole = |film: &Film| {
            film.aov(Aov::Object)
                .unwrap()
                .iter()
                .filter(|o| **o == 1.0)
                .count()
        };
        let (own, right) = (hole(&masked) as f64, hole(&cut) as f64);
        assert!(
            right > 20.0 && (own / right - 1.0).abs() < 0.1,
            "{method}: {own} {right}"
        );
    }
}

/// glTF 2.0 §3.9.4: opaque where alpha is at least the cutoff. 51/255 = 0.2 and 170/255 = 2/3, though f32(0.2) > 1/5 and f32(2/3) > 2/3.
#[test]
fn a_surface_whose_alpha_is_the_cutoff_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let image = |alpha: u8| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgba);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[200, 200, 200, alpha]).unwrap();
        writer.finish().unwrap();
        bytes
    };
    for (alpha, cutoff, is_there) in [
        (51, 0.2, true),
        (51, 0.2001, false),
        (170, 2.0 / 3.0, true),
        (169, 2.0 / 3.0, false),
    ] {
        let material = json!({
            "name": "paint", "alphaMode": "MASK", "alphaCutoff": cutoff,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 },
        });
        let quad = files::Quad {
            image: Some(&image(alpha)),
            material: Some(&material.to_string()),
            ..files::Quad::PLAIN
        };
        files::glb(&folder.path().join("even.glb"), &quad);
        let text = format!("{}[[object]]\ngltf = 'even.glb'\n", camera(""));
        let film = stage::film(&stage::scene_in(folder.path(), &text));
        let met = stage::met(&film).len();
        assert_eq!(met > 20, is_there, "{alpha}/255, cutoff {cutoff}: {met}");
        assert!(is_there || met == 0, "{alpha}/255, cutoff {cutoff}: {met}");
    }
}

#[test]
fn holes_of_shining_surfaces_do_not_shine() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    for bounces in [0, 1] {
        let keys = format!(
            "{}[display]\nsamples_per_pixel = 256\n[render]\nbounces = {bounces}\n[sky]\nradiance = 0.01\nlights = true",
            camera("")
        );
        let mean = |masked| {
            let film = stage::rendered(
                &scene(folder.path(), masked, true, &keys),
                &stage::sampled(),
            )
            .unwrap();
            let sum: f64 = film.radiance().iter().map(|c| c[1]).sum();
            sum / film.radiance().len() as f64
        };
        // Of 300,000 samples the means are apart by less than 0.3 %; a whole lamp would light the floor twice as much.
        stage::assert_relative(mean(true), mean(false), 0.01, format!("{bounces} bounces"));
    }
}

#[test]
fn alpha_is_the_factor_times_that_of_the_vertices() {
    // Alpha falls from 1 on the left to 0 on the right: with a factor of 0.8 and a cutoff of 0.6 it ends at x = −1 + 2·(1 − 0.75).
    let square = |right: f64| {
        let corners = [[-1.0, -1.0], [right, -1.0], [right, 1.0], [-1.0, 1.0]];
        let positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]], [0.5; 3])
    };
    let mut masked = square(1.0);
    masked.colours = [1.0, 0.0, 0.0, 1.0]
        .map(|alpha| [1.0, 1.0, 1.0, alpha])
        .to_vec();
    let material = &mut masked.materials[0];
    (material.alpha, material.alpha_mode) = (0.8, AlphaMode::Mask { cutoff: 0.6 });
    let film = |mesh: Mesh| {
        let scene = Builder::from_toml("vertices", &camera("velocity = { beta = [0, 0, 0.6] }"))
            .mesh("screen", Arc::new(mesh))
            .build()
            .unwrap();
        stage::film(&scene)
    };
    let (masked, cut) = (film(masked), film(square(-0.5)));
    assert_same(&masked, &cut, "vertices");
    assert!(stage::met(&cut).len() > 20);
    assert_eq!(stage::met(&masked), stage::met(&cut));
}
