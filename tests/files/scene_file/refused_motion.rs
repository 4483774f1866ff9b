//! Errors in a camera's motion, sensor, rotation and shutter, and with the paper's equations.

use crate::scene_file::cases::check;
use crate::scene_file::{Folder, problem};

const VELOCITY: &str = "velocity = { beta = 0.5, direction = [0, 0, -1] }";
const TIME: &str = "time = \"2 ns\"";
const EYE: &str = "eye = [0, 1, 5]";
const PLACE: &str = "eye = [0, 1, 5]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [64, 48]\nvelocity = { beta = 0.5, direction = [0, 0, -1] }\ntime = \"2 ns\"\n";
const HFOV: &str = "hfov = \"40 deg\"";
const SHIP: &str = "velocity = { beta = [0.5, 0, 0] }";

cases! { MOTION:
    TIME => "motion = {}" at "camera.motion" "{}": "no motion is given", "`acceleration`, `segments`, `profile`, `keyframes`, `animation` or `circle`";
    TIME => "motion = { acceleration = { proper = \"0 /m\" }, segments = [] }" at "camera.motion.segments" "[]": "given twice, as `acceleration` and as `segments`", "exactly one";
    TIME => "motion = { segments = [{}], keyframes = [] }" at "camera.motion.keyframes" "[]": "given twice, as `segments` and as `keyframes`", "exactly one";
    TIME => "motion.speed = 1" at "camera.motion.speed" "speed": "unknown key `speed`", "acceleration, animation, axes, circle, keyframes, profile, segments";
    TIME => "motion.acceleration = { proper = 0.1 }" at "camera.motion.acceleration.proper" "0.1": "an acceleration is a text like \"0.1 /m\"", "magnitude";
    TIME => "motion.acceleration = { proper = \"1 m\" }" at "camera.motion.acceleration.proper" "\"1 m\"": "\"m\" is not a unit of an acceleration", "9.81 m/s2";
    TIME => "motion.acceleration = { proper = \"0.1 /m\" }" at "camera.motion.acceleration" "{ proper": "has no direction", "add direction";
    TIME => "motion.acceleration = { proper = \"0.1 /m\", direction = [0, 0, 0] }" at "camera.motion.acceleration.direction" "[0, 0, 0]": "zero vector", "length above 0";
    TIME => "motion.acceleration.direction = [0, 0, 1]" at "camera.motion.acceleration" "acceleration": "the key `proper` is missing", "magnitude";
    TIME => "motion.segments = []" at "camera.motion.segments" "[]": "0 segments are too few", "1 to 100000";
    TIME => "motion.segments = [{}, { duration = \"1 m\" }]" at "camera.motion.segments[0]" "{}": "no `duration`, and is not the last", "for ever";
    TIME => "motion.segments = [{ duration = \"0 m\" }]" at "camera.motion.segments[0].duration" "\"0 m\"": "`duration` is 0, which is not above 0", "above 0";
    TIME => "motion.segments = [{ acceleration = { proper = \"1 /m\" } }]" at "camera.motion.segments[0].acceleration" "{ proper": "no direction", "add direction";
    TIME => "motion.profile = [{ time = \"0 m\" }]" at "camera.motion.profile" "[{ time": "1 times of a profile are too few", "2 to 100000";
    TIME => "motion.profile = [{ time = \"0 m\" }, { time = \"2 m\" }, { time = \"2 m\" }, { time = \"1 m\" }]" at "camera.motion.profile[2].time" "\"2 m\"": "the time 2 m is not after that of the previous entry, 2 m", "in the order of their times";
    TIME => "motion.profile = [{ time = \"1 m\" }, { time = \"2 m\" }]" at "camera.motion.profile" "[{ time": "from 1 m to 2 m, does not contain camera time 0", "begin there, or before";
}

cases! { PATHS:
    TIME => "motion.keyframes = []" at "camera.eye" "[0, 1, 5]": "`keyframes` and `eye` exclude each other", "keep one";
    EYE => "motion.keyframes = []" at "camera.velocity" "{ beta": "`keyframes` and `velocity` exclude each other", "keep one";
    PLACE => "look_at = [0, 0, 0]\nclock_zero = \"0 m\"\nmotion.keyframes = [{ time = \"0 m\", position = [0, 0, 5] }]\n" at "camera.clock_zero" "\"0 m\"": "`keyframes` and `clock_zero` exclude each other", "keep one";
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"0 m\", position = [0, 0, 5] }]\n" at "camera.motion.keyframes" "[{ time": "1 keyframes are too few", "2 to 100000";
    PLACE => "look_at = [0, 0, 5]\nmotion.keyframes = [{ time = \"0 m\", position = [0, 0, 5] }, { time = \"1 m\", position = [0, 0, 5] }]\n" at "camera.look_at" "[0, 0, 5]": "the same point", "another point";
    PLACE => "motion.keyframes = [{ time = \"0 m\", position = [0, 0, 5] }, { time = \"1 m\", position = [0, 0, 5] }]\n" at "camera" "[camera]": "`look_at` is missing", "look_at";
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"1 m\", position = [0, 0, 5] }, { time = \"1 cm\", position = [0, 0, 5] }]\n" at "camera.motion.keyframes[1].time" "\"1 cm\"": "1 cm is not after that of the previous entry, 1 m", "order";
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"1 m\", position = [0, 0, 5] }, { time = \"6 m\", position = [3, 0, 5] }, { time = \"8 m\", position = [3, 4, 5] }]\n" at "camera.motion.keyframes[2].position" "[3, 4, 5]": "this keyframe is 4 m from the previous one, and 2 m of time after it: |β| = 2", "as fast as light";
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"1 m\", position = [0, 0, 5] }, { time = \"6 m\", position = [5, 0, 5] }]\n" at "camera.motion.keyframes[1].position" "[5, 0, 5]": "|β| = 1", "as fast as light";
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"0 m\" }, { time = \"6 m\", position = [5, 0, 5] }]\n" at "camera.motion.keyframes[0]" "{ time": "the key `position` is missing", "World position";
    TIME => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], period = \"1 km\" }" at "camera.velocity" "{ beta": "`circle` and `velocity` exclude each other", "keep one";
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 0, 0], period = \"1 km\" }" at "camera.motion.circle.axis" "[0, 0, 0]": "zero vector", "[0, 1, 0]";
    VELOCITY => "motion.circle = { centre = [0, 7, 5], axis = [0, 1, 0], period = \"1 km\" }" at "camera.motion.circle.centre" "[0, 7, 5]": "passes through `eye`", "on the circle";
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0] }" at "camera.motion.circle" "{ centre": "no speed", "period = \"60 m\" or rate";
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], period = \"1 m\", rate = \"1 rad/m\" }" at "camera.motion.circle.rate" "\"1 rad/m\"": "`period` and `rate` exclude", "keep one";
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], period = \"0 m\" }" at "camera.motion.circle.period" "\"0 m\"": "`period` is 0", "above 0";
    // 5 m from the axis: |ω| below 0.2 rad/m, periods above 10π m.
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], rate = \"-0.2 rad/m\" }" at "camera.motion.circle.rate" "\"-0.2 rad/m\"": "5 m around the axis, |β| = 1 is not below 1", "the largest rate is -0.1998 rad/m";
    VELOCITY => "motion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], period = \"31.41 m\" }" at "camera.motion.circle.period" "\"31.41 m\"": "is not below 1", "the shortest period is 31.45 m";
}

cases! { WORLD_LINES:
    TIME => "motion.segments = [{ duration = \"1 m\" }, { duration = \"100 m\", acceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] } }]" at "camera.motion.segments[1]" "{ duration = \"100 m\"": "this acceleration exceeds rapidity 40 near", "weaker or shorter";
    TIME => "motion.profile = [{ time = \"0 m\" }, { time = \"1 m\" }, { time = \"90 m\", acceleration = { proper = \"1 /m\", direction = [0, 0, -1] } }]" at "camera.motion.profile[1]" "{ time = \"1 m\"": "this acceleration exceeds rapidity 40 near", "weaker or shorter";
    TIME => "time = \"50 m\"\nmotion.acceleration = { proper = \"1 /m\", direction = [0, 0, -1] }" at "camera.time" "\"50 m\"": "the exposure begins where the camera is too fast", "nearer to 0";
    TIME => "time = \"30 m\"\nshutter.duration = \"20 m\"\nmotion.acceleration = { proper = \"1 /m\", direction = [0, 0, -1] }" at "camera.shutter.duration" "\"20 m\"": "the exposure ends where the camera is too fast", "nearer to 0";
    // The chord is slower than light, the curve that has to pick up speed and to lose it is not.
    PLACE => "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = \"0 m\", position = [0, 0, 5] }, { time = \"1 m\", position = [0, 0, 5] }, { time = \"2 m\", position = [0.95, 0, 5] }, { time = \"3 m\", position = [0.95, 0, 5] }]\n" at "camera.motion.keyframes[2]" "{ time = \"2 m\"": "from the previous keyframe to this one moves at |β| = 1.", "gentler turns";
}

cases! { TIMES:
    TIME => "time = \"-1 m\"\nmotion.profile = [{ time = \"0 m\" }, { time = \"2 m\" }]" at "camera.time" "\"-1 m\"": "the exposure begins before the camera's world line does", "from 0 m to 2 m";
    TIME => "time = \"3 m\"\nmotion.profile = [{ time = \"0 m\" }, { time = \"2 m\" }]" at "camera.time" "\"3 m\"": "the exposure begins after the camera's world line has ended", "from 0 m to 2 m";
    TIME => "time = \"1 m\"\nshutter.duration = \"1.5 m\"\nmotion.profile = [{ time = \"0 m\" }, { time = \"2 m\" }]" at "camera.shutter.duration" "\"1.5 m\"": "the exposure ends after the camera's world line has ended", "from 0 m to 2 m";
    PLACE => "look_at = [0, 0, 0]\ntime = \"-1 m\"\nmotion.keyframes = [{ time = \"7 m\", position = [0, 0, 5] }, { time = \"12 m\", position = [3, 0, 5] }]\n" at "camera.time" "\"-1 m\"": "before the camera's world line", "from 0 m to 4 m";
    PLACE => "look_at = [0, 0, 0]\ntime = \"4.1 m\"\nmotion.keyframes = [{ time = \"7 m\", position = [0, 0, 5] }, { time = \"12 m\", position = [3, 0, 5] }]\n" at "camera.time" "\"4.1 m\"": "after the camera's world line has ended", "from 0 m to 4 m";
    TIME => "frame_interval = \"0 m\"" at "camera.frame_interval" "\"0 m\"": "`frame_interval` is 0", "above 0";
    TIME => "shutter.duration = \"-1 ns\"" at "camera.shutter.duration" "\"-1 ns\"": "not above 0", "above 0";
    TIME => "shutter.records = \"mean\"" at "camera.shutter" "shutter": "the key `duration` is missing", "above 0";
    TIME => "shutter = { duration = \"1 ns\", records = \"sum\" }" at "camera.shutter.records" "\"sum\"": "sum is not one of mean, energy", "the integral over the exposure";
}

cases! { SENSOR:
    TIME => "sensor.focal_length = \"-36 mm\"" at "camera.sensor.focal_length" "\"-36 mm\"": "-36 mm would put the pinhole behind the sensor", "above 0";
    TIME => "sensor.focal_length = \"0 mm\"" at "camera.sensor.focal_length" "\"0 mm\"": "`focal_length` is 0", "above 0";
    TIME => "sensor.width = \"24 mm\"" at "camera.sensor" "sensor": "the key `focal_length` is missing", "Distance from the sensor to the pinhole";
    TIME => "sensor = { focal_length = \"36 mm\", width = \"24 mm\" }" at "camera.sensor.width" "\"24 mm\"": "`hfov` and `sensor.width` exclude each other", "keep one";
    HFOV => "sensor = { focal_length = \"36 mm\", width = \"0 mm\" }" at "camera.sensor.width" "\"0 mm\"": "`width` is 0", "above 0";
    HFOV => "sensor = { focal_length = \"36 mm\", width = \"1e10 km\" }" at "camera.sensor.width" "\"1e10 km\"": "a field of view of 3.14159", "like \"24 mm\" at \"36 mm\"";
    TIME => "sensor = { focal_length = \"36 mm\", assembly = \"ships\" }" at "camera.sensor.assembly" "\"ships\"": "ships is not one of rigid, world_length, bell", "What fixes";
    TIME => "sensor = { focal_length = \"2 m\" }\nmotion.acceleration = { proper = \"0.5 /m\", direction = [0, -1, -5] }" at "camera.sensor.focal_length" "\"2 m\"": "at a proper acceleration of 0.5 /m a rigid body ends 2 m behind its pinhole", "assembly = \"bell\"";
    TIME => "sensor = { focal_length = \"3 m\" }\nmotion.segments = [{ duration = \"1 m\" }, { acceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] } }]" at "camera.sensor.focal_length" "\"3 m\"": "a rigid body ends 2 m", "shorter focal length";
    PLACE => "eye = [0, 1, 5]\nlook_at = [0, 1, 0]\nsize = [64, 48]\nsensor = { focal_length = \"2 m\", width = \"1 um\" }\nshutter.duration = \"9 m\"\nmotion.profile = [{ time = \"0 m\", acceleration = { proper = \"0.49999999999 /m\", direction = [0, 0, -1] } }, { time = \"9 m\", acceleration = { proper = \"0.4999999999 /m\", direction = [0, 0, -1] } }]\n" at "camera.sensor.focal_length" "\"2 m\"": "may reach farther at another moment", "shorter focal length";
    TIME => "sensor = { focal_length = \"3 m\" }\nmotion.profile = [{ time = \"0 m\" }, { time = \"9 m\", acceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] } }]" at "camera.sensor.focal_length" "\"3 m\"": "a rigid body ends 2 m", "shorter focal length";
}

cases! { ROTATION:
    TIME => "rotation = { axis = [0, 0, 0], rate = \"1 rad/m\" }" at "camera.rotation.axis" "[0, 0, 0]": "zero vector", "[0, 1, 0]";
    TIME => "rotation = { axis = [0, 1, 0] }" at "camera.rotation" "{ axis": "the key `rate` is missing", "Angle per camera time";
    TIME => "rotation = { axis = [0, 1, 0], rate = \"1 rad\" }" at "camera.rotation.rate" "\"1 rad\"": "\"rad\" is not a unit of an angular rate", "10 deg/ns";
    TIME => "rotation = { axis = [0, 1, 0], rate = \"1 rad/m\", elements = \"comoving\" }" at "camera.rotation.elements" "\"comoving\"": "need a sensor", "[camera.sensor]";
    TIME => "rotation = { axis = [0, 1, 0], rate = \"1 rad/m\", elements = \"aberrated\" }" at "camera.rotation.elements" "\"aberrated\"": "need a sensor", "[camera.sensor]";
    TIME => "rotation = { axis = [0, 1, 0], rate = \"1 rad/m\", through = \"sensor\" }" at "camera.rotation.through" "\"sensor\"": "this camera has none", "[camera.sensor]";
    TIME => "rotation = { axis = [0, 1, 0], rate = \"1 rad/m\" }\nmotion.acceleration = { proper = \"1 /m\", direction = [1, 0, 0] }" at "camera.rotation" "{ axis": "only in a camera without acceleration", "leave out";
    VELOCITY => "rotation = { axis = [0, 1, 0], rate = \"1 rad/m\" }\nmotion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], rate = \"0.1 rad/m\" }" at "camera.rotation" "{ axis": "only in a camera without acceleration", "leave out";
    // A square sensor of 6 m: its corners are √18 m from its centre. |Ω| is below 1/√18 = 0.2357 rad/m.
    "hfov = \"40 deg\"\nsize = [64, 48]" => "size = [9, 9]\nsensor = { focal_length = \"4 m\", width = \"6 m\" }\nrotation = { axis = [0, -1, -5], rate = \"0.25 rad/m\" }" at "camera.rotation.rate" "\"0.25 rad/m\"": "4.24264068711928", "the largest rate is 0.2355 rad/m";
    "hfov = \"40 deg\"\nsize = [64, 48]" => "size = [9, 9]\nsensor = { focal_length = \"4 m\", width = \"6 m\" }\nrotation = { axis = [0, -1, -5], rate = \"-30 deg/m\", through = \"sensor\" }" at "camera.rotation.rate" "\"-30 deg/m\"": "|ΩR| = 2.22144", "the largest rate is -13.49 deg/m";
    // About an axis to the right through a pinhole 4 m away: corners 3 m off it vertically, R = 5 m.
    "hfov = \"40 deg\"\nsize = [64, 48]\nvelocity = { beta = 0.5, direction = [0, 0, -1] }" => "size = [9, 9]\nsensor = { focal_length = \"4 m\", width = \"6 m\" }\nrotation = { axis = [1, 0, 0], rate = \"0.201 rad/m\" }" at "camera.rotation.rate" "\"0.201 rad/m\"": "5 m from the axis", "the largest rate is 0.1998 rad/m";
}

cases! { PAPER:
    "[medium]" => "[[light]]\ntype = \"area\"\nobject = \"ship\"\nradiance = 1\n[medium]" at "light[0].object" "\"ship\"": "ship\" moves in a medium of index 1.5", "let the lamp rest";
    "[medium]" => "model = \"paper\"\n[medium]" at "model" "\"paper\"": "paper is not one of exact, paper2015", "Jarabo";
    "[medium]" => "model = \"paper2015\"\n[medium]" at "object[2].velocity" "{ beta = [0.5, 0, 0] }": "the paper's world is static, and \"ship\" moves", "model = \"exact\"";
}

/// Cases of a world without moving objects, in the paper's equations.
fn paper(keys: &str) -> String {
    let text = crate::scene_file::VALID
        .replacen(SHIP, "", 1)
        .replacen(TIME, keys, 1);
    format!("model = \"paper2015\"\n{text}")
}

#[test]
fn motions_that_cannot_be_are_refused() {
    check(MOTION);
}

#[test]
fn paths_that_cannot_be_are_refused() {
    check(PATHS);
}

#[test]
fn world_lines_that_nothing_can_follow_are_refused() {
    check(WORLD_LINES);
}

#[test]
fn exposures_that_cannot_be_are_refused() {
    check(TIMES);
}

#[test]
fn sensors_that_cannot_be_are_refused() {
    check(SENSOR);
}

#[test]
fn rotations_that_cannot_be_are_refused() {
    check(ROTATION);
}

#[test]
fn what_the_paper_does_not_have_is_refused_of_its_equations() {
    check(PAPER);
    let folder = Folder::with_files();
    let acceleration = "motion.acceleration = { proper = '0.1 /m', direction = [0, 0, -3] }";
    assert!(folder.parse(&paper(acceleration)).is_ok());
    for (keys, place, what, help) in [
        (
            "motion.segments = [{ duration = '1 m' }, { acceleration = { proper = '0.1 /m', direction = [1, 0, 0] } }]",
            "camera.motion",
            "inertial or have one constant proper acceleration",
            "`acceleration`",
        ),
        (
            "motion.profile = [{ time = '0 m' }, { time = '1 m' }]",
            "camera.motion",
            "inertial or have one constant",
            "no motion",
        ),
        (
            "motion.acceleration = { proper = '0.1 /m', direction = [0, 1, 3] }",
            "camera.motion",
            "this one is slowing down or turning",
            "along the motion",
        ),
        (
            "motion.acceleration = { proper = '0.1 /m', direction = [0, 0, -1] }\n\
             shutter = { duration = '1 m' }",
            "camera.motion",
            "exposures are of cameras at constant speed",
            "[camera.shutter]",
        ),
        (
            "sensor = { focal_length = '1 cm' }\n\
             rotation = { axis = [0, 1, 0], rate = '1 rad/m', elements = 'comoving' }",
            "camera.velocity",
            "rotates a camera at rest",
            "model = \"exact\"",
        ),
        (
            "rotation = { axis = [0, 1, 0], rate = '1 rad/m' }",
            "camera.rotation",
            "no exact rotation",
            "\"comoving\" or \"aberrated\"",
        ),
        (
            "rotation = { axis = [0, 1, 0], rate = '1 rad/m', elements = 'exact' }",
            "camera.rotation.elements",
            "no exact rotation",
            "\"comoving\" or \"aberrated\"",
        ),
    ] {
        let refusal = problem(folder.parse(&paper(keys)));
        assert_eq!(refusal.place, place);
        assert!(refusal.what.contains(what), "{}", refusal.what);
        assert!(refusal.help.contains(help), "{}", refusal.help);
    }
}

#[test]
fn more_than_a_hundred_thousand_keyframes_are_refused() {
    let key = |i: usize| format!("{{time=\"{i}m\",position=[0,0,5]}},");
    let keys = |n: usize| {
        let keys: String = (0..n).map(key).collect();
        let keys = format!("look_at = [0, 0, 0]\nmotion.keyframes = [{keys}]\n");
        crate::scene_file::VALID.replacen(PLACE, &keys, 1)
    };
    let folder = Folder::with_files();
    assert!(folder.parse(&keys(100_000)).is_ok());
    let refusal = problem(folder.parse(&keys(100_001)));
    let what = "100001 keyframes are too many";
    assert!(refusal.what.contains(what), "{}", refusal.what);
}

#[test]
fn a_rigid_sensor_beyond_the_horizon_in_the_middle_of_an_exposure_is_refused() {
    // The path turns around at 1.2 m, with x″ = −5.6 /m in between by the spline, and is almost straight at both ends of the exposure.
    let text = |focal: &str| {
        format!(
            "[camera]\nforward = [0, 0, -1]\nhfov = \"60 deg\"\ntime = \"0 m\"\nsensor = {{ focal_length = \"{focal}\" }}\n\
             shutter = {{ duration = \"2 m\" }}\nmotion = {{ keyframes = [{{ time = \"0 m\", position = [0, 0, 0] }}, \
             {{ time = \"1 m\", position = [0, 0, 0.3] }}, {{ time = \"1.2 m\", position = [0, 0, 0.36] }}, \
             {{ time = \"1.4 m\", position = [0, 0, 0.3] }}, {{ time = \"3 m\", position = [0, 0, 0] }}] }}\n\
             [[object]]\nshape = {{ sphere = {{ radius = 5 }} }}\n"
        )
    };
    let parsed = |focal: &str| {
        nullray::scene::parse(
            &text(focal),
            "a.toml",
            ".".as_ref(),
            &nullray::scene::Overrides::default(),
        )
    };
    let refused = parsed("0.6 m").unwrap_err().to_string();
    assert!(refused.contains("behind its pinhole"), "{refused}");
    assert!(parsed("0.05 m").is_ok());
}
