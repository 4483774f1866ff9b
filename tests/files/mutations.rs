//! Valid files with bytes changed, numbers replaced and ends cut off: the outcome is a result or an error, never a panic, a hang or
//! excessive memory.

use nullray::io::cube::{self, Wanted};
use nullray::io::gltf;

use crate::ALL;

fn valid(file: &str) -> Vec<u8> {
    std::fs::read(format!("tests/data/valid/{file}")).unwrap()
}

const GLTF: [&str; 7] = [
    "hierarchy.glb",
    "topologies.glb",
    "textured.glb",
    "sparse.glb",
    "embedded.gltf",
    "cameras.glb",
    "quantized.glb",
];

const ARRAYS: [(&str, Option<&str>); 5] = [
    ("cube-f4.npy", None),
    ("cube-f2.npy", None),
    ("cube-f4-version-3.npy", None),
    ("stored.npz", None),
    ("deflated.npz", Some("cube")),
];

/// Imports; a mesh that comes out must be sound. Tells whether one did.
fn import_gltf(bytes: &[u8]) -> bool {
    let Ok(imported) = gltf::load_bytes(bytes, "mutated", None, ALL) else {
        return false;
    };
    let mesh = imported.mesh;
    let indices = mesh.triangles.iter().flatten();
    assert!(mesh.positions.iter().all(|position| position.is_finite()));
    assert!(
        indices
            .max()
            .is_some_and(|&index| (index as usize) < mesh.positions.len())
    );
    let covered: u32 = mesh.parts.iter().map(|part| part.triangles).sum();
    assert_eq!(covered as usize, mesh.triangles.len());
    assert!(
        mesh.parts
            .iter()
            .all(|part| (part.material as usize) < mesh.materials.len())
    );
    true
}

fn import_array(bytes: &[u8], array: Option<&str>) -> bool {
    let wanted = Wanted {
        array,
        ..Wanted::default()
    };
    cube::load_bytes(bytes, "mutated", wanted).is_ok()
}

/// Every byte, changed in four ways.
fn each_byte_changed(valid: &[u8], mut import: impl FnMut(&[u8])) {
    let mut bytes = valid.to_vec();
    for at in 0..valid.len() {
        for mask in [0x01, 0x10, 0x80, 0xff] {
            bytes[at] ^= mask;
            import(&bytes);
            bytes[at] = valid[at];
        }
    }
}

#[test]
fn a_changed_byte_of_a_gltf_file_never_panics() {
    for file in GLTF {
        assert!(import_gltf(&valid(file)), "{file}");
        each_byte_changed(&valid(file), |bytes| {
            import_gltf(bytes);
        });
    }
}

#[test]
fn a_changed_byte_of_an_array_never_panics() {
    for (file, array) in ARRAYS {
        assert!(import_array(&valid(file), array), "{file}");
        each_byte_changed(&valid(file), |bytes| {
            import_array(bytes, array);
        });
    }
}

#[test]
fn a_truncated_file_is_refused_at_every_length() {
    for file in GLTF {
        let bytes = valid(file);
        for length in 0..bytes.len() {
            assert!(!import_gltf(&bytes[..length]), "{file} at {length}");
        }
    }
    for (file, array) in ARRAYS {
        let bytes = valid(file);
        for length in 0..bytes.len() {
            assert!(!import_array(&bytes[..length], array), "{file} at {length}");
        }
    }
}

/// JSON and binary chunk of a GLB file.
fn chunks(glb: &[u8]) -> (String, &[u8]) {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json = String::from_utf8(glb[20..20 + length].to_vec()).unwrap();
    (json, &glb[20 + length..])
}

fn glb(json: &str, rest: &[u8]) -> Vec<u8> {
    let json = format!(
        "{json}{}",
        " ".repeat(json.len().next_multiple_of(4) - json.len())
    );
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((20 + json.len() as u32 + rest.len() as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.bytes());
    glb.extend(rest);
    glb
}

/// Byte ranges of the numbers of a JSON text (and of digits in names, which does no harm).
fn numbers(json: &str) -> Vec<std::ops::Range<usize>> {
    let mut numbers = Vec::new();
    let mut rest = 0..json.len();
    while let Some(start) = json[rest.clone()].find(|c: char| c.is_ascii_digit() || c == '-') {
        let start = rest.start + start;
        let length = json[start..].find(|c: char| !"+-.eE0123456789".contains(c));
        let end = length.map_or(json.len(), |length| start + length);
        numbers.push(start..end);
        rest.start = end;
    }
    numbers
}

#[test]
fn a_number_replaced_by_any_other_never_panics() {
    const OTHERS: [&str; 14] = [
        "0",
        "1",
        "2",
        "3",
        "7",
        "-1",
        "255",
        "65536",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "9223372036854775807",
        "1e38",
        "1e400",
    ];
    for file in GLTF.iter().filter(|file| file.ends_with(".glb")) {
        let bytes = valid(file);
        let (json, rest) = chunks(&bytes);
        assert!(
            import_gltf(&glb(&json, rest)),
            "{file} taken apart and put together"
        );
        for number in numbers(&json) {
            for other in OTHERS {
                let mut changed = json.clone();
                changed.replace_range(number.clone(), other);
                import_gltf(&glb(&changed, rest));
            }
        }
    }
}

/// Several bytes at once, by a fixed sequence (xorshift64*), so that every run is the same.
#[test]
fn many_changed_bytes_never_panic() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = move |below: usize| {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % below
    };
    for round in 0..2000 {
        let (gltf, (array, name)) = (GLTF[round % GLTF.len()], ARRAYS[round % ARRAYS.len()]);
        let (mut mesh, mut cube) = (valid(gltf), valid(array));
        for _ in 0..=next(8) {
            let (at, byte) = (next(mesh.len()), next(256) as u8);
            mesh[at] = byte;
            let (at, byte) = (next(cube.len()), next(256) as u8);
            cube[at] = byte;
        }
        import_gltf(&mesh);
        import_array(&cube, name);
    }
}
