//! Comparing pictures: metrics against other programs, geometric errors against known shifts, planted errors.

mod another_camera;
mod arrays;
mod browser;
mod by_light;
mod false_names;
mod first_versions;
mod hidden_bugs;
mod light_and_objects;
mod light_and_sizes;
mod metrics;
mod one_object_or_camera;
mod other_frames;
mod other_numbers;
mod pictures;
mod planted;
mod planting;
mod program;
mod refusals;
mod surfaces;
mod usual_bugs;
mod wrong_places;
