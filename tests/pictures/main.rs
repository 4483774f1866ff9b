//! Pictures and their ingredients: rays, cameras, light, films, rasterizers.

#[path = "../common"]
mod common {
    pub mod arrays;
    pub mod frames;
    pub mod table;
    pub mod worst;
}

mod accel;
mod alpha_masks;
mod baked;
mod bricks;
mod cameras;
mod capture;
mod captures;
mod companions;
mod exposures;
mod flashes;
mod footprints;
mod gallery;
mod in_memory;
mod lookups;
mod mitransient;
mod mitsuba;
mod moving_meshes;
mod paper_scenes;
mod paper_versus_exact;
mod pipeline;
mod raster;
mod scenes;
mod spans;
mod steady;
mod survey;
mod suspicious;
mod textures;
mod time_texture;
mod transient;
