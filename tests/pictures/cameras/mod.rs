//! Cameras: sensor, pinhole, shutter and motion, against reference vectors and closed forms.

mod accelerated;
mod agreement;
mod bench_camera;
mod paper;
mod projections;
mod reference;
