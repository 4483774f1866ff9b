//! Vertices that are not finite, and the smallest that are: through the library's tree and through files.

use std::path::Path;

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Kernel, Origins, Precision, Ray, Traversal};
use nullray::io::gltf::{self, Want};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::{BadTextures, BadVertices};
use nullray::scene::{Overrides, parse};
use nullray::{Error, Result};

use crate::stability::cases::Random;

/// NaN, infinities, and numbers at the ends of f64.
const ODD: [f64; 9] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    -0.0,
];

/// What each kernel meets.
fn hits(bvh: &Bvh, origin: DVec3, directions: &[DVec3]) -> Vec<Option<(u32, f64)>> {
    let all = Kernel::ALL.map(|kernel| {
        let precision = Precision::Certified;
        let mut hits = vec![None; directions.len()];
        bvh.closest_by(
            Traversal { kernel, precision },
            Origins::Shared(origin),
            directions,
            &mut hits,
            None,
            None,
        );
        hits.iter()
            .map(|h| h.map(|h| (h.triangle, h.s)))
            .collect::<Vec<_>>()
    });
    assert!(all.iter().all(|hits| *hits == all[0]));
    all[0].clone()
}

#[test]
fn odd_vertices_in_a_tree_hide_none_of_the_others_and_end_no_traversal_late() {
    let mut random = Random::new(5);
    let good: Vec<[DVec3; 3]> = (0..300)
        .map(|_| {
            let at = random.vector();
            [0; 3].map(|_| at + random.vector() * 0.3)
        })
        .collect();
    let mut mesh = good.clone();
    for (i, odd) in ODD.iter().cycle().take(300).enumerate() {
        let mut triangle = good[i];
        triangle[i % 3][i / 3 % 3] = *odd;
        // NaN, infinite, or beyond reach: the last triangles of the tree, and never met.
        if !odd.is_finite() || odd.abs() > Bvh::MAX_COORDINATE {
            mesh.push(triangle);
        }
    }
    let [clean, mixed] = [good, mesh].map(|m| Bvh::build(m, |_| Facing::TwoSided));
    assert_eq!((clean.len(), clean.bounds()), (mixed.len(), mixed.bounds()));
    for _ in 0..100 {
        let origin = random.vector() * 3.0;
        let directions: Vec<DVec3> = (0..64).map(|_| random.vector() * 0.5 - origin).collect();
        assert_eq!(
            hits(&clean, origin, &directions),
            hits(&mixed, origin, &directions)
        );
    }
}

#[test]
fn odd_rays_into_a_tree_of_odd_vertices_return() {
    let mut random = Random::new(6);
    let mut odd = || ODD[(random.share() * 9.0) as usize];
    let mut point = || DVec3::new(odd(), odd(), odd());
    let mut mesh: Vec<[DVec3; 3]> = (0..500).map(|_| [point(), point(), point()]).collect();
    mesh.push([DVec3::X, DVec3::Y, DVec3::Z]);
    let bvh = Bvh::build(mesh, |_| Facing::TwoSided);
    for _ in 0..2000 {
        let directions: Vec<DVec3> = (0..16).map(|_| point()).collect();
        let origin = point();
        for hit in hits(&bvh, origin, &directions).into_iter().flatten() {
            assert!(hit.1.is_finite());
        }
        let s_min = origin.x;
        let ray = Ray {
            origin,
            direction: directions[0],
            s_min,
        };
        bvh.any(&ray, directions[1].y, None);
    }
}

/// A .glb of a square of two triangles, then one triangle whose corner 4 and whose texture coordinates are
/// as given.
fn write(path: &Path, corner: [f32; 3], uv: [f32; 2]) {
    write_scaled(path, corner, uv, 1.0);
}

/// The same, `scale` times as long along z.
fn write_scaled(path: &Path, corner: [f32; 3], uv: [f32; 2], scale: f32) {
    let at = [
        [-1., -1., 0.],
        [1., -1., 0.],
        [1., 1., 0.],
        [-1., 1., 0.],
        corner,
    ];
    let uvs = [[0., 1.], [1., 1.], [1., 0.], [0., 0.], uv];
    let indices: [u16; 9] = [0, 1, 4, 0, 1, 2, 0, 2, 3];
    let mut data: Vec<u8> = Vec::new();
    data.extend(at.iter().flatten().flat_map(|x: &f32| x.to_le_bytes()));
    data.extend(uvs.iter().flatten().flat_map(|x: &f32| x.to_le_bytes()));
    data.extend(indices.iter().flat_map(|x| x.to_le_bytes()));
    data.resize(data.len().next_multiple_of(4), 0);
    let json = serde_json::json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0, "scale": [1.0, 1.0, scale] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2 }] }],
        "buffers": [{ "byteLength": data.len() }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 60 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 40 },
            { "buffer": 0, "byteOffset": 100, "byteLength": 18 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3",
              "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 5, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 9, "type": "SCALAR" },
        ],
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + json.len() as u32 + data.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", data)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    std::fs::write(path, file).unwrap();
}

/// The square's scene with this line in its object, and the warnings of its preparation.
fn film(folder: &Path, line: &str) -> Result<(Film, Vec<String>)> {
    let text = format!(
        "camera = {{ eye = [0.1, 0.2, 3], look_at = [0, 0, 0], size = [16, 16] }}\n\
         display = {{ back_faces = \"two_sided\", samples_per_pixel = 1 }}\n\
         [[object]]\ngltf = \"square.glb\"\n{line}\n"
    );
    let scene = parse(&text, "scene.toml", folder, &Overrides::default())?;
    let request = Request {
        aovs: vec![Aov::Primitive],
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request)?;
    let prepared = Prepared::new(&scene, &plan, &Silent)?;
    Ok((render(&prepared, &Silent)?, prepared.warnings))
}

fn refused(result: Result<(Film, Vec<String>)>) -> Box<nullray::error::Problem> {
    match result {
        Err(Error::Invalid(problem)) => problem,
        other => panic!("not refused: {:?}", other.map(|r| r.1)),
    }
}

#[test]
fn bad_vertices_are_refused_with_their_place_and_both_remedies() {
    let folder = tempfile::tempdir().unwrap();
    for (corner, what) in [
        ([0.0, f32::NAN, 0.0], "the position 0, NaN, 0 is not finite"),
        (
            [f32::INFINITY, 0.0, 0.0],
            "the position inf, 0, 0 is not finite",
        ),
    ] {
        write(&folder.path().join("square.glb"), corner, [0.0; 2]);
        let problem = refused(film(folder.path(), ""));
        assert!(problem.file.ends_with("square.glb"), "{}", problem.file);
        assert_eq!(problem.place, "mesh 0, primitive 0, accessor 0, vertex 4");
        assert!(problem.what.contains(what), "{}", problem.what);
        assert!(problem.help.contains("finite numbers"), "{}", problem.help);
        assert!(
            problem.help.contains("bad_vertices = \"drop\""),
            "{}",
            problem.help
        );
    }
}

#[test]
fn dropped_triangles_are_counted_and_leave_the_others_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.glb");
    // Behind the square, and hidden by it.
    write(&path, [0.0, 0.0, -1.0], [0.0; 2]);
    let (whole, warnings) = film(folder.path(), "").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    for corner in [[f32::NAN, 0.0, 0.0], [0.0, f32::NEG_INFINITY, 0.0]] {
        write(&path, corner, [0.0; 2]);
        let (film, warnings) = film(folder.path(), "bad_vertices = \"drop\"").unwrap();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(
            warnings[0].contains("not finite are dropped"),
            "{warnings:?}"
        );
        let numbers = |film: &Film| film.aov(Aov::Primitive).unwrap().to_vec();
        assert_eq!(numbers(&film), numbers(&whole));
        assert!(numbers(&film).contains(&1.0) && numbers(&film).contains(&2.0));
    }
}

#[test]
fn non_finite_texture_coordinates_are_dropped_like_positions() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.glb");
    write(&path, [0.0, 0.0, 1.0], [f32::NAN, 0.0]);
    let want = |bad_vertices| Want {
        uvs: true,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices,
        bad_textures: BadTextures::Refuse,
    };
    assert!(gltf::load(&path, None, want(BadVertices::Refuse)).is_err());
    let imported = gltf::load(&path, None, want(BadVertices::Drop)).unwrap();
    assert_eq!(imported.mesh.triangles, [[0, 0, 0], [0, 1, 2], [0, 2, 3]]);
    assert!(imported.mesh.positions.iter().all(|p| p.is_finite()));
    assert!(
        imported.warnings[0].contains("dropped"),
        "{:?}",
        imported.warnings
    );
    // Where nobody asks for them, they are not read.
    let plain = Want {
        uvs: false,
        ..want(BadVertices::Refuse)
    };
    assert!(gltf::load(&path, None, plain).is_ok());
}

#[test]
fn vertices_beyond_the_reach_of_rays_are_bad_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.glb");
    write_scaled(&path, [0.0, 0.0, -3e38], [0.0; 2], 3e38);
    // 9e76 m are within 2³⁰⁰ = 2e90, and 9e106 are not.
    let (_, warnings) = film(folder.path(), "").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let far = "transform = { matrix = [1,0,0,0, 0,1,0,0, 0,0,1e30,0, 0,0,0,1] }";
    let problem = refused(film(folder.path(), far));
    assert!(problem.file.ends_with("square.glb"), "{}", problem.file);
    assert_eq!(problem.place, "object \"square\", vertex 4");
    assert!(problem.help.contains("2e90"), "{}", problem.help);
    let dropping = format!("{far}\nbad_vertices = \"drop\"");
    let (film, warnings) = film(folder.path(), &dropping).unwrap();
    assert!(
        warnings[0].contains("1 triangles with a vertex that is out of range"),
        "{warnings:?}"
    );
    assert!(film.aov(Aov::Primitive).unwrap().contains(&2.0));
}

#[test]
fn denormal_positions_of_a_file_are_kept_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.glb");
    let least = f32::from_bits(1);
    write(
        &path,
        [least, -least * 77.0, f32::from_bits(0x7f_ffff)],
        [0.0; 2],
    );
    let want = Want {
        uvs: false,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let imported = gltf::load(&path, None, want).unwrap();
    let least = libm::exp2(-149.0);
    let expected = DVec3::new(least, -77.0 * least, f64::from(0x7f_ffff) * least);
    assert_eq!(imported.mesh.positions[4], expected);
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
}
