//! Cameras: sensor, pinhole, shutter and motion, against reference vectors and closed forms.

#[path = "../common/table.rs"]
mod table;
#[path = "../common/worst.rs"]
mod worst;

mod accelerated;
mod agreement;
mod bench_camera;
mod paper;
mod reference;
