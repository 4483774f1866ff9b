//! Errors in all parts of a scene, row by row.

use crate::scene_file::cases::check;
use crate::scene_file::{Folder, VALID, problem};

const HFOV: &str = "hfov = \"40 deg\"";
const CAMERA_VELOCITY: &str = "velocity = { beta = 0.5, direction = [0, 0, -1] }";
const PLANE: &str = "{ plane = { size = [4, 4] } }";
const TRANSFORM: &str = "transform = { translate = [1, 2, 3], scale = 2 }";
const CAPTURE: &str = "capture = { eye = [0, 0, 9], look_at = [0, 0, 0], hfov = \"30 deg\" }";
const PULSE: &str = "pulse = { position = [0, 2, 0], sigma = \"2 cm\" }";

cases! { STRUCTURE:
    "hfov =" => "hfv =" at "camera.hfv" "hfv": "unknown key `hfv`", "did you mean `hfov`?";
    "[medium]" => "[medum]" at "medum" "medum": "unknown key `medum`", "did you mean `medium`?";
    "sigma =" => "sgma =" at "source[1].pulse.sgma" "sgma": "unknown key `sgma`", "`sigma`";
    "before =" => "befor =" at "outside.befor" "befor": "unknown key", "did you mean `before`?";
    "[camera]" => "[Camera]" at "Camera" "Camera": "unknown key `Camera`", "did you mean `camera`?";
    "bin_width = \"5 cm\", " => "" at "source[0].cube" "{ file": "the key `bin_width` is missing", "add the width of a bin";
    "eye = [0, 1, 5]" => "" at "camera" "[camera]": "the key `eye` is missing", "give eye and look_at";
    "size = [64, 48]" => "size = \"big\"" at "camera.size" "\"big\"": "invalid type: string", "Width and height";
    "size = [64, 48]" => "size = [64]" at "camera.size" "[64]": "invalid length 1", "Width and height";
    "eye = [0, 1, 5]" => "eye = [0, 1]" at "camera.eye" "[0, 1]": "an array of 3 numbers", "World position";
    "eye = [0, 1, 5]" => "eye = [0, 1, 5, 6]" at "camera.eye" "[0, 1, 5, 6]": "invalid length 4", "metres";
    "eye = [0, 1, 5]" => "eye = [0, true, 5]" at "camera.eye[1]" "true": "expected a number", "World position";
    "velocity = { beta = [0.5, 0, 0] }" => "velocity = 0.5" at "object[2].velocity" "0.5": "a table like { beta", "Velocity in the world";
    "clock = \"capture\"" => "clock = \"capture\", scale = 0" at "source[0].cube.scale" "0": "`scale` is 0, which is not above 0", "`scale` is above 0";
    "clock = \"capture\"" => "clock = \"capture\", scale = -2" at "source[0].cube.scale" "-2": "not above 0", "`scale` is above 0";
    "clock = \"capture\"" => "clock = \"captur\"" at "source[0].cube.clock" "\"captur\"": "captur is not one of world, object, capture", "did you mean \"capture\"?";
    "before = \"hold\"" => "before = \"blck\"" at "outside.before" "\"blck\"": "blck is not one of", "did you mean \"black\"?";
    "quantity = \"line\"" => "quantity = \"lines\"" at "radiance.quantity" "\"lines\"": "lines is not one of", "did you mean \"line\"?";
    "hfov =" => "eye =" at "line 7" "eye": "not TOML: duplicate key", "TOML";
    "eye = [0, 1, 5]" => "eye = [0, .5, 5]" at "line 5" "": "not TOML: a number has digits on both sides of its point: 0.8, not .8", "TOML";
    "[display]" => "[display" at "line 40" "": "not TOML", "TOML";
}

cases! { UNITS:
    "\"40 deg\"" => "40" at "camera.hfov" "40": "the number 40 has no unit: an angle is a text like \"40 deg\"", "Horizontal field of view";
    "\"40 deg\"" => "\"40 m\"" at "camera.hfov" "\"40 m\"": "\"m\" is not a unit of an angle (units: deg or rad)", "Horizontal";
    "\"2 ns\"" => "0.5" at "camera.time" "0.5": "a time is a text like \"0.5 m\"", "proper time";
    "\"2 ns\"" => "\"2\"" at "camera.time" "\"2\"": "has no unit", "proper time";
    "\"2 ns\"" => "\"2 deg\"" at "camera.time" "\"2 deg\"": "not a unit of a time", "proper time";
    "\"2 ns\"" => "\"soon\"" at "camera.time" "\"soon\"": "\"soon\" is not a time", "proper time";
    "\"2 ns\"" => "\"1e30 s\"" at "camera.time" "\"1e30 s\"": "beyond 1e30", "shorter";
    "\"532 nm\"" => "\"532 ns\"" at "radiance.wavelength" "\"532 ns\"": "not a unit of a wavelength", "emitted wavelength";
    "\"98 %\"" => "98" at "display.exposure" "98": "like \"98 %\"", "percentile";
    "eye = [0, 1, 5]" => "eye = [0, nan, 5]" at "camera.eye[1]" "nan": "NaN is not a finite number", "World position";
    "index = 1.5" => "index = inf" at "medium.index" "inf": "inf is not a finite number", "Refractive index";
    "eye = [0, 1, 5]" => "eye = [0, 1e31, 5]" at "camera.eye[1]" "1e31": "beyond 1e30", "World position";
    "[medium]" => "speed_of_light = \"0 m/s\"\n[medium]" at "speed_of_light" "\"0 m/s\"": "not above 0", "positive";
    "[medium]" => "speed_of_light = \"3e8\"\n[medium]" at "speed_of_light" "\"3e8\"": "no unit", "speed of light";
}

cases! { CAMERA:
    "index = 1.5" => "index = 0.9" at "medium.index" "0.9": "0.9 is below 1", "vacuum";
    HFOV => "hfov = \"180 deg\"" at "camera.hfov" "\"180 deg\"": "180 deg is not between 0 and 180", "below 180 deg";
    HFOV => "hfov = \"0 deg\"" at "camera.hfov" "\"0 deg\"": "not between", "above 0";
    HFOV => "hfov = \"-1 rad\"" at "camera.hfov" "\"-1 rad\"": "not between", "above 0";
    "[64, 48]" => "[0, 48]" at "camera.size" "[0, 48]": "0 by 48", "1 to 65536";
    "[64, 48]" => "[65537, 1]" at "camera.size" "[65537, 1]": "65537 by 1", "1 to 65536";
    "[64, 48]" => "[65536, 65536]" at "camera.size" "[65536, 65536]": "4294967296 pixels", "at most 268435456";
    "[64, 48]" => "[64, 48, \"x\"]" at "camera.size" "[64, 48, \"x\"]": "invalid length 3, expected an array of length 2", "Width and height";
    "[64, 48]" => "[-64, 48]" at "camera.size[0]" "-64": "-64 is not a whole number", "Width and height";
    "look_at = [0, 0, 0]\nhfov" => "look_at = [0, 1, 5]\nhfov" at "camera.look_at" "[0, 1, 5]": "the same point", "another point";
    HFOV => "up = [0, 1, 5]" at "camera.up" "[0, 1, 5]": "parallel", "not along the line of sight";
    HFOV => "up = [0, 0, 0]" at "camera.up" "[0, 0, 0]": "zero vector", "not zero";
    "eye = [0, 1, 5]" => "eye = [0, 1, 0]" at "camera.look_at" "[0, 0, 0]": "parallel", "`up`";
    HFOV => "gltf = \"a.glb\"" at "camera.eye" "[0, 1, 5]": "`gltf` and `eye` exclude each other", "keep one";
    HFOV => "node = \"cam\"" at "camera.node" "\"cam\"": "no file is given", "add gltf";
    CAMERA_VELOCITY => "velocity = { beta = [0, 0, 1] }" at "camera.velocity.beta" "[0, 0, 1]": "|β| = 1 is not below 1", "one_minus_beta";
    CAMERA_VELOCITY => "velocity = { beta = -1.5, direction = [1, 0, 0] }" at "camera.velocity.beta" "-1.5": "|β| = 1.5", "below 1";
    CAMERA_VELOCITY => "velocity = { beta = 0.5 }" at "camera.velocity.beta" "0.5": "no direction of motion", "add direction";
    CAMERA_VELOCITY => "velocity = { gamma = 2, direction = [0, 0, 0] }" at "camera.velocity.direction" "[0, 0, 0]": "zero vector", "length above 0";
    CAMERA_VELOCITY => "velocity = { gamma = 0.5, direction = [1, 0, 0] }" at "camera.velocity.gamma" "0.5": "γ = 0.5 is below 1", "at least 1";
    CAMERA_VELOCITY => "velocity = { one_minus_beta = 0, direction = [1, 0, 0] }" at "camera.velocity.one_minus_beta" "0": "not in (0, 1]", "above 0";
    CAMERA_VELOCITY => "velocity = { rapidity = [41, 0, 0] }" at "camera.velocity.rapidity" "[41, 0, 0]": "rapidity 41 is above 40", "smaller";
    CAMERA_VELOCITY => "velocity = { beta = 0.5, gamma = 2 }" at "camera.velocity.gamma" "2": "given twice, as `beta` and as `gamma`", "one way";
    CAMERA_VELOCITY => "velocity = { beta = [0.5, 0, 0], direction = [1, 0, 0] }" at "camera.velocity.direction" "[1, 0, 0]": "its own direction", "leave `direction` out";
    CAMERA_VELOCITY => "velocity = {}" at "camera.velocity" "{}": "no velocity", "beta = [0.9, 0, 0]";
}

cases! { OBJECTS:
    "node = \"Wheel\"" => "bad_vertices = \"keep\"" at "object[0].bad_vertices" "\"keep\"": "keep is not one of refuse, drop", "\"refuse\" the file";
    "node = \"Wheel\"" => "bad_textures = \"keep\"" at "object[0].bad_textures" "\"keep\"": "keep is not one of refuse, drop", "\"refuse\" the file";
    "colour = [1, 0.5, 0.25]" => "bad_textures = \"drop\"" at "object[2].bad_textures" "\"drop\"": "`shape` and `bad_textures` exclude", "keep one";
    "colour = [1, 0.5, 0.25]" => "bad_vertices = \"drop\"" at "object[2].bad_vertices" "\"drop\"": "`shape` and `bad_vertices` exclude", "keep one";
    "name = \"ship\"" => "name = \"floor\"" at "object[2].name" "\"floor\"": "two objects are named \"floor\"", "of its own";
    "name = \"ship\"" => "name = \" \"" at "object[2].name" "\" \"": "the name is empty", "leave the key out";
    "gltf = \"a.glb\"" => "gltf = \"missing.glb\"" at "object[0].gltf" "\"missing.glb\"": "cannot find this file", "relative to the scene file";
    "gltf = \"a.glb\"" => "gltf = \"folder.glb\"" at "object[0].gltf" "\"folder.glb\"": "not a regular file", "relative";
    "gltf = \"a.glb\"" => "gltf = \"a.obj\"" at "object[0].gltf" "\"a.obj\"": "neither a .glb nor a .gltf", ".glb";
    "gltf = \"a.glb\"" => "gltf = \"\"" at "object[0].gltf" "\"\"": "empty", "give";
    "gltf = \"a.glb\"" => "gltf = \"a\\u0000.glb\"" at "object[0].gltf" "\"a\\u0000.glb\"": "cannot find this file", "relative";
    "gltf = \"a.glb\"" => "gltf = \"a.glb\"\ncolour = [1, 1, 1]" at "object[0].colour" "[1, 1, 1]": "`gltf` and `colour` exclude", "keep one";
    "gltf = \"a.glb\"" => "gltf = \"a.glb\"\nshape = { sphere = { radius = 1 } }" at "object[0].shape" "{ sphere = { radius = 1 } }": "exclude each other", "keep one";
    "colour = [1, 0.5, 0.25]" => "node = \"x\"" at "object[2].node" "\"x\"": "`shape` and `node` exclude", "keep one";
    "colour = [1, 0.5, 0.25]" => "colour = [1, -0.5, 0]" at "object[2].colour" "[1, -0.5, 0]": "below 0", "[0.8, 0.8, 0.8]";
    "shape = { box = { size = [1, 2, 3] } }\ncolour = [1, 0.5, 0.25]" => "" at "object[2]" "[[object]]": "no geometry", "add gltf";
    PLANE => "{}" at "object[1].shape" "{}": "no shape", "exactly one";
    PLANE => "{ plane = { size = [4, 4] }, sphere = { radius = 1 } }" at "object[1].shape" "{ plane": "more than one shape", "exactly one";
    PLANE => "{ cone = { size = [4, 4] } }" at "object[1].shape.cone" "cone": "unknown key `cone`", "box, lattice, plane, sphere";
    PLANE => "{ plane = { size = [4, 0] } }" at "object[1].shape.plane.size" "[4, 0]": "an edge is 0, which is not above 0", "above 0";
    PLANE => "{ sphere = { radius = -1 } }" at "object[1].shape.sphere.radius" "-1": "`radius` is -1", "above 0";
    PLANE => "{ sphere = { radius = 1e-31 } }" at "object[1].shape.sphere.radius" "1e-31": "below 1e-30", "above 0";
    PLANE => "{ sphere = { radius = 1, subdivisions = 9 } }" at "object[1].shape.sphere.subdivisions" "9": "20·4^9 triangles", "0 to 8";
    PLANE => "{ lattice = { cells = [1, 65, 1], spacing = 1, bar = 0.1 } }" at "object[1].shape.lattice.cells" "[1, 65, 1]": "1 to 64 cells", "[4, 4, 4]";
    PLANE => "{ lattice = { cells = [1, 1, 1], spacing = 1, bar = 1 } }" at "object[1].shape.lattice.bar" "1": "fills the whole cell", "below `spacing`";
    TRANSFORM => "transform = { scale = 0 }" at "object[0].transform.scale" "0": "singular", "not 0";
    TRANSFORM => "transform = { scale = [1, 0, 1] }" at "object[0].transform.scale" "[1, 0, 1]": "singular", "not 0";
    TRANSFORM => "transform = { matrix = [1,0,0,0, 2,0,0,0, 0,0,1,0, 0,0,0,1] }" at "object[0].transform.matrix" "[1,0,0,0, 2": "singular", "span space";
    TRANSFORM => "transform = { matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1] }" at "object[0].transform.matrix" "[1,0,0,0, 0": "last row", "last column";
    TRANSFORM => "transform = { matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0] }" at "object[0].transform.matrix" "[1,0,0,0, 0": "invalid length 12", "4×4";
    TRANSFORM => "transform = { scale = 2, matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }" at "object[0].transform.scale" "2": "`matrix` and `scale` exclude", "keep one";
    TRANSFORM => "transform = { rotate = { axis = [0, 0, 0], angle = \"1 deg\" } }" at "object[0].transform.rotate.axis" "[0, 0, 0]": "zero vector", "[0, 1, 0]";
}

cases! { SOURCES:
    "name = \"flash\"" => "name = \"data\"" at "source[1].name" "\"data\"": "two sources are named", "of its own";
    "objects = [\"floor\"]" => "objects = [\"flor\"]" at "source[1].objects[0]" "\"flor\"": "there is no object named \"flor\"", "did you mean \"floor\"?";
    "objects = [\"floor\"]" => "objects = []" at "source[1].objects" "[]": "empty", "leave the key out";
    "objects = [\"floor\"]" => "objects = [\"floor\", \"floor\"]" at "source[1].objects[1]" "\"floor\"": "named twice", "once";
    "objects = [\"floor\"]" => "objects = [\"wheel\"]" at "source[1].name" "\"flash\"": "same surface of \"wheel\"", "`materials`";
    "objects = [\"floor\"]" => "" at "source[1].name" "\"flash\"": "same surface of \"wheel\"", "one cube";
    "objects = [\"floor\"]" => "objects = [\"wheel\"]\nmaterials = [\"hub\", \"rim\"]" at "source[1].name" "\"flash\"": "same surface", "one cube";
    "objects = [\"floor\"]" => "objects = [\"wheel\"]\nmaterials = [\"hub\"]\npulse = { position = [0, 1, 0], sigma = \"1 cm\" }\n[[source]]\nname = \"third\"\nobjects = [\"wheel\"]" at "source[2].name" "\"third\"": "same surface of \"wheel\"", "`materials`";
    "objects = [\"wheel\"]" => "objects = [\"wheel\", \"ship\"]" at "source[0].cube.capture" "{ eye": "both \"wheel\" and \"ship\"", "share one frame";
    PULSE => "" at "source[1]" "[[source]]": "neither a cube nor a pulse", "add cube";
    PULSE => "pulse = { position = [0, 2, 0], sigma = \"2 cm\" }\ncube = { file = \"a.npy\", bin_width = \"1 m\" }" at "source[1].pulse" "{ position": "exclude each other", "keep one";
    CAPTURE => "uv = 0" at "source[0].cube.clock" "\"capture\"": "position of that camera", "add capture";
    CAPTURE => "uv = 300" at "source[0].cube.uv" "300": "no TEXCOORD_300", "like 0";
    CAPTURE => "uv = 0, capture = { eye = [0, 0, 9], look_at = [0, 0, 0], hfov = \"30 deg\" }" at "source[0].cube.capture" "{ eye": "`uv` and `capture` exclude", "keep one";
    ", hfov = \"30 deg\"" => "" at "source[0].cube.capture" "{ eye": "`hfov` is missing", "hfov = \"40 deg\"";
    "\"30 deg\"" => "\"200 deg\"" at "source[0].cube.capture.hfov" "\"200 deg\"": "not between", "below 180";
    ", hfov = \"30 deg\"" => ", fov = \"30 deg\"" at "source[0].cube.capture.fov" "\"30 deg\"": "axis of this field of view", "fov_axis";
    ", hfov = \"30 deg\"" => ", hfov = \"30 deg\", fov_axis = \"y\"" at "source[0].cube.capture.fov_axis" "\"y\"": "the axis of `fov`", "as `fov`";
    ", hfov = \"30 deg\"" => ", hfov = \"30 deg\", fov = \"3 deg\"" at "source[0].cube.capture.fov" "\"3 deg\"": "exclude each other", "keep one";
    ", hfov = \"30 deg\"" => ", hfov = \"30 deg\", near_clip = -1" at "source[0].cube.capture.near_clip" "-1": "at a depth of -1 m", "at least 0";
    ", hfov = \"30 deg\"" => ", hfov = \"30 deg\", projection = \"equirectangular\", near_clip = 1" at "source[0].cube.capture.near_clip" "1": "perspective cameras only", "`projection` out";
    ", hfov = \"30 deg\"" => ", hfov = \"30 deg\", crop = { film = [4, 4], offset = [4, 0] }" at "source[0].cube.capture.crop" "{ film": "not on a film of [4, 4]", "whole film";
    "bin_width = \"5 cm\"" => "bin_width = \"5 cm\", axes = \"T H X\"" at "source[0].cube.axes" "\"T H X\"": "'X'", "H rows";
    "bin_width = \"5 cm\"" => "bin_width = \"5 cm\", axes = \"H W\"" at "source[0].cube.bin_width" "\"5 cm\"": "describes a time axis", "add T";
    "\"5 cm\"" => "\"0 cm\"" at "source[0].cube.bin_width" "\"0 cm\"": "`bin_width` is 0", "like \"0.05 m\"";
    "\"5 cm\"" => "\"-1 ps\"" at "source[0].cube.bin_width" "\"-1 ps\"": "not above 0", "above 0";
    "a.npz" => "missing.npz" at "source[0].cube.file" "\"missing.npz\"": "cannot find this file", "relative";
    "a.npz" => "a.glb" at "source[0].cube.file" "\"a.glb\"": "neither a .npy nor a .npz", ".npz";
    "a.npz" => "a.npy" at "source[0].cube.array" "\"x\"": "without a name", "leave `array` out";
    "\"2 cm\"" => "\"0 cm\"" at "source[1].pulse.sigma" "\"0 cm\"": "`sigma` is 0", "above 0";
    "sigma = \"2 cm\"" => "sigma = \"2 cm\", intensity = -1" at "source[1].pulse.intensity" "-1": "below 0", "[r, g, b]";
    "sigma = \"2 cm\"" => "sigma = \"2 cm\", intensity = \"x\"" at "source[1].pulse.intensity" "\"x\"": "a number or an array of 3 numbers", "Energy per solid angle";
    PULSE => "pulse = { position = [0, 2, 0], sigma = \"2 cm\" }\nradiance = { wavelength = \"500 nm\" }" at "source[1].radiance.wavelength" "\"500 nm\"": "only the radiance of a spectral line", "leave `wavelength` out";
}

cases! { SETTINGS:
    "wavelength = \"532 nm\"" => "" at "radiance.quantity" "\"line\"": "needs its wavelength", "wavelength = \"532 nm\"";
    "\"532 nm\"" => "\"0 nm\"" at "radiance.wavelength" "\"0 nm\"": "not above 0", "above 0";
    "quantity = \"line\"" => "quantity = \"photons\"" at "radiance.wavelength" "\"532 nm\"": "only the radiance of a spectral line", "quantity = \"line\"";
    "exposure = \"98 %\"" => "luminances = [2, 1]" at "display.luminances" "[2, 1]": "is empty", "[1e-4, 1e2]";
    "exposure = \"98 %\"" => "luminances = [0, 1]" at "display.luminances" "[0, 1]": "not above 0", "[1e-4, 1e2]";
    "exposure = \"98 %\"" => "logarithmic = [2, 1]" at "display.logarithmic" "[2, 1]": "is empty", "lower one first";
    "exposure = \"98 %\"" => "exposure = \"98 %\"\nlogarithmic = [1, 2]" at "display.logarithmic" "[1, 2]": "exclude each other", "keep one";
    "exposure = \"98 %\"" => "isochrones = { flash = [0, 1, 0], clock = \"mine\" }" at "display.isochrones.clock" "\"mine\"": "mine", "capture camera";
    "\"98 %\"" => "\"0 %\"" at "display.exposure" "\"0 %\"": "not above 0 and at most 100 %", "99 %";
    "\"98 %\"" => "\"101 %\"" at "display.exposure" "\"101 %\"": "at most 100 %", "white";
    "exposure = \"98 %\"" => "white = 0" at "display.white" "0": "`white` is 0", "above 0";
    "exposure = \"98 %\"" => "exposure = \"98 %\"\nwhite = 1" at "display.white" "1": "exclude each other", "keep one";
    "exposure = \"98 %\"" => "background = [0, 0, -1]" at "display.background" "[0, 0, -1]": "below 0", "at least 0";
    "exposure = \"98 %\"" => "back_faces = \"front\"" at "display.back_faces" "\"front\"": "front is not one of", "Which faces";
    "samples_per_pixel = 16" => "samples_per_pixel = 0" at "display.samples_per_pixel" "0": "0 samples", "1 to 65536";
    "samples_per_pixel = 16" => "samples_per_pixel = 65537" at "display.samples_per_pixel" "65537": "65537 samples", "1 to 65536";
    "[display]" => "[render]\nbounces = -1\n[display]" at "render.bounces" "-1": "-1 is not a whole number, 0 or above", "0 to 64";
    "[display]" => "[render]\nbounces = 5000000000\n[display]" at "render.bounces" "5000000000": "5000000000 is too large", "0 to 64";
    "[display]" => "[render]\nbounces = 2.5\n[display]" at "render.bounces" "2.5": "2.5 is not a whole number", "0 to 64";
    "size = [64, 48]" => "size = [64, \"a\"]" at "camera.size[1]" "\"a\"": "string \"a\" is not a whole number", "Width and height";
    "[display]" => "[render]\nbounces = 65\n[display]" at "render.bounces" "65": "65 bounces", "0 to 64";
    "[display]" => "[render]\nbounces = 1\n[effects]\nretardation = false\n[display]" at "render.bounces" "1": "cannot be traced from surface to surface", "effects.retardation";
    "[display]" => "[effects]\ndoppler = 1\n[display]" at "effects.doppler" "1": "expected a boolean", "emitted wavelength";
}

#[test]
fn what_is_not_of_the_format_is_refused_at_its_place() {
    check(STRUCTURE);
}

#[test]
fn quantities_without_their_units_or_bounds_are_refused() {
    check(UNITS);
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    check(CAMERA);
}

#[test]
fn objects_that_cannot_be_are_refused() {
    check(OBJECTS);
}

#[test]
fn sources_that_cannot_be_are_refused() {
    check(SOURCES);
}

#[test]
fn settings_out_of_range_are_refused() {
    check(SETTINGS);
}

#[test]
fn a_scene_without_objects_or_camera_is_refused() {
    let folder = Folder::with_files();
    let refusal = problem(folder.parse("[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n"));
    assert!(refusal.what.contains("no object"), "{}", refusal.what);
    assert!(refusal.help.contains("[[object]]"), "{}", refusal.help);
    let refusal = problem(folder.parse(""));
    assert_eq!(refusal.what, "the key `camera` is missing");
}

#[test]
fn both_places_of_a_contradiction_are_shown() {
    let folder = Folder::with_files();
    let text = VALID.replacen("name = \"ship\"", "name = \"floor\"", 1);
    let shown = folder.parse(&text).unwrap_err().report(false);
    assert!(shown.contains("first here"), "{shown}");
}
