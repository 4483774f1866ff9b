use super::*;

fn file(size: &str, pixels: &[u8]) -> Vec<u8> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
    [header.as_bytes(), pixels].concat()
}

fn all(bytes: &[u8]) -> Result<([usize; 2], Vec<[f32; 3]>)> {
    read(bytes, "a.hdr".as_ref(), &Budget::default())
}

#[test]
fn pixels_are_read_in_each_way_of_writing_them() {
    // 2^(129 − 136) = 1/128: (128 + ½)/128 is red.
    let expected = [1.003_906_3, 0.503_906_25, 0.003_906_25];
    let flat = [[128, 64, 0, 129]; 2].concat();
    let old = [[128, 64, 0, 129], [1, 1, 1, 1]].concat();
    for pixels in [flat, old] {
        let ([w, h], read) = all(&file("-Y 1 +X 2", &pixels)).unwrap();
        assert_eq!(([w, h], read), ([2, 1], vec![expected; 2]));
    }
    // By component: runs of 7 and 1, or 8 values.
    let mut new = vec![2, 2, 0, 8];
    new.extend([128 + 7, 128, 128 + 1, 128]);
    new.extend([8, 64, 64, 64, 64, 64, 64, 64, 64]);
    new.extend([128 + 8, 0, 128 + 8, 129]);
    let (_, read) = all(&file("-Y 1 +X 8", &new)).unwrap();
    assert_eq!(read, vec![expected; 8]);
}

#[test]
fn headers_say_what_pixels_are_and_are_believed_or_refused() {
    let with = |line: &[u8]| {
        let start = b"#?RADIANCE\n";
        let pixels = b"\n\n-Y 1 +X 1\n\x80\x80\x80\x81";
        all(&[start, line, pixels].concat())
    };
    // (128 + ½)/128, divided by the factors in the values.
    let white = 1.003_906_3;
    let known: [(&[u8], [f32; 3]); 6] = [
        (b"FORMAT= 32-bit_rle_rgbe \r", [white; 3]),
        (b"EXPOSURE=2\nEXPOSURE= 2", [white / 4.0; 3]),
        (b"COLORCORR=1 2 4", [white, white / 2.0, white / 4.0]),
        (
            b"PRIMARIES=0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333",
            [white; 3],
        ),
        // About a picture from which this one was made.
        (b"\tEXPOSURE=nothing", [white; 3]),
        // A name in Latin-1.
        (b"CAMERA=caf\xe9", [white; 3]),
    ];
    for (line, expected) in known {
        let (_, read) = with(line).unwrap();
        assert_eq!(read, [expected], "{:?}", String::from_utf8_lossy(line));
    }
    let refused: [(&[u8], &str); 7] = [
        (b"FORMAT=32-bit_rle_xyze ", "XYZE"),
        (b"FORMAT= 32-bit_rle_xyze", "XYZE"),
        (b"FORMAT=64-bit", "its FORMAT is"),
        (b"EXPOSURE=1,5", "its EXPOSURE is"),
        (b"EXPOSURE=0", "its EXPOSURE is"),
        (b"COLORCORR=2 2", "its COLORCORR is"),
        (
            b"PRIMARIES=0.7347 0.2653 0 1 0.0001 -0.077 0.32168 0.33767",
            "Rec. 709",
        ),
    ];
    for (line, said) in refused {
        let error = with(line).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
}

#[test]
fn broken_files_are_refused() {
    for (size, pixels) in [
        ("-Y 1 +X 2", &[0u8; 7][..]),
        ("-Y 1 +X 2", &[1, 1, 1, 2]),
        ("-Y 1 +X 8", &[2, 2, 0, 8, 0]),
        ("-Y 1 +X 8", &[2, 2, 0, 9, 128 + 9, 0]),
        ("+X 1 -Y 2", &[0; 8]),
        ("-Y 30000 +X 30000", &[0; 8]),
        ("-Y 0 +X 1", &[]),
    ] {
        assert!(all(&file(size, pixels)).is_err(), "{size} {pixels:?}");
    }
    assert!(all(b"#?RADIANCE\n").is_err());
    assert!(all(b"P6").is_err());
}
