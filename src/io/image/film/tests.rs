use super::*;

#[test]
fn rates_become_fractions_of_a_second() {
    let delay = |fps| {
        let Delay {
            numerator,
            denominator,
        } = Delay::of_rate(fps).unwrap();
        (numerator, denominator)
    };
    assert_eq!(delay(24.0), (1, 24));
    assert_eq!(delay(12.5), (80, 1000));
    assert_eq!(delay(0.5), (2000, 1000));
    assert_eq!(delay(29.97), (100, 2997));
    assert_eq!(delay(30000.0 / 1001.0), (1001, 30000));
    assert_eq!(delay(24000.0 / 1001.0), (1001, 24000));
    assert_eq!(delay(60.0), (1, 60));
    // π is within 1e-7 of 355/113.
    assert_eq!(delay(std::f64::consts::PI), (113, 355));
    for fps in [1e9, 1e-9, 65_536.0, f64::NAN, f64::INFINITY, 0.0, -1.0] {
        assert!(Delay::of_rate(fps).is_err(), "{fps}");
    }
}

#[test]
fn raw_video_has_the_codes_of_bt_709() {
    // White, black and the primaries by the equations above: red has Y′ = 54.213, so 16 + 46.56; Cb −29.216, so
    // 128 − 25.66; Cr 127.5, so 128 + 112.
    let rgb = [255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 0, 255];
    let mut file = Vec::new();
    let delay = Delay::of_rate(25.0).unwrap();
    let mut film = FilmWriter::y4m("a.y4m".as_ref(), &mut file, [4, 1], 1, delay).unwrap();
    film.picture(&RgbImage {
        width: 4,
        height: 1,
        rgb: rgb.into(),
    })
    .unwrap();
    film.finish().unwrap();
    let header = "YUV4MPEG2 W4 H1 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\nFRAME\n";
    let (head, codes) = file.split_at(header.len());
    assert_eq!(head, header.as_bytes());
    // Blue: Y′ = 18.411, so 16 + 15.81; Cb 127.5, so 240; Cr −11.691, so 128 − 10.27.
    assert_eq!(
        codes,
        [235, 16, 63, 32, 128, 128, 102, 240, 128, 128, 240, 118]
    );
}

#[test]
fn films_hold_as_many_pictures_of_their_size_as_they_say() {
    let picture = |width| RgbImage {
        width,
        height: 1,
        rgb: vec![7; 3 * width as usize],
    };
    let delay = Delay::of_rate(10.0).unwrap();
    let name = Path::new("a.apng");
    let film = |count| FilmWriter::apng(name, Vec::new(), [2, 1], count, delay, &[]);
    assert!(film(0).is_err());
    let mut two = film(2).unwrap();
    assert!(two.picture(&picture(3)).is_err());
    two.picture(&picture(2)).unwrap();
    assert!(two.finish().is_err());
    let mut one = film(1).unwrap();
    one.picture(&picture(2)).unwrap();
    assert!(one.picture(&picture(2)).is_err());
    one.finish().unwrap();
}

#[test]
fn an_error_of_writing_names_the_file() {
    // A disk with room for 600 bytes: the beginnings of both formats, and less than a picture.
    let name = Path::new("there/a.film");
    let said = |film: &mut FilmWriter<&mut [u8]>| {
        let picture = RgbImage {
            width: 64,
            height: 64,
            rgb: (0..3 * 64 * 64u32).map(|k| (k * k / 7) as u8).collect(),
        };
        film.picture(&picture).unwrap_err().to_string()
    };
    let delay = Delay::of_rate(10.0).unwrap();
    let (mut one, mut other) = ([0; 600], [0; 600]);
    let raw = FilmWriter::y4m(name, &mut one[..], [64, 64], 1, delay);
    let animated = FilmWriter::apng(name, &mut other[..], [64, 64], 1, delay, &[]);
    for film in [raw, animated] {
        let said = said(&mut film.unwrap());
        assert!(said.contains("there/a.film"), "{said}");
    }
}
