//! The text of the help and the man pages, apart from the options.

use std::fmt::Write;

use nullray::render::aov::Aov;

pub const PROGRAM: &str = "\
Examples:
  nullray                            render the built-in scene into nullray-out/
  nullray render scene.toml          write scene.png
  nullray render model.glb --beta 0.9  see a model at 0.9 c, without a scene
  nullray film scene.toml --flyby 0.9  make a film, scene.apng
  nullray page scene.toml -o DIR     make an HTML page with a slider for the speed
  nullray sheet scene.toml           write its panels on one labelled page, scene-sheet.png
  nullray diagram scene.toml         draw its world lines, scene.svg
  nullray export scene.toml -o DIR   write it for other renderers, with reference pictures
  nullray study scene.toml           measure run time against error, by several methods
  nullray plan scene.toml            show what rendering it needs, without rendering
  nullray info data.npz              show what a file holds
  nullray selftest                   test this build on this machine
  nullray help render                all options, examples and channel names

Exit codes: 0 done; 1 `compare` exceeded a --tolerance or could not judge it, or a check of `selftest` failed; 2 wrong arguments, bad input, \
or a file that cannot be read or written; 101 a bug in nullray; 130 stopped by Ctrl-C or SIGTERM, with no unfinished file left \
except those needed to resume.

No environment variable changes what is computed; NO_COLOR turns off colours in messages.";

pub const RENDER: &str = "\
Examples:
  nullray render scene.toml -o still.png -o data.exr --aovs all
  nullray render scene.toml --error \"1 %\" --budget \"5 min\" -o still.exr
  nullray render scene.toml --time \"2 ns\" --set \"camera.velocity={beta=[0,0,-0.5]}\"
  nullray render scene.toml --size 320x240 --spp 1 --isochrones times.png
  nullray render scene.toml --overlay figure.pdf --overlay-parts outlines,beta
  nullray render scene.toml --from \"0 ns\" --to \"10 ns\" --fps 5e9 --white 0.5 -o \"frame-####.png\"
  nullray render scene.toml --frames 50..100 --interval \"2 cm\" -o film.exr
  nullray render scene.toml --frames 0..72 --interval \"2 cm\" -o film.apng --caption \"a crate\"
  nullray render scene.toml --frames 0..72 --interval \"2 cm\" -o - | ffmpeg -i - -pix_fmt yuv420p film.mp4
  nullray render figure.toml --panel beta-0.9 -o right.png
  nullray render model.glb --beta 0.9 --direction x
  nullray render model.glb --flyby -o \"frame-####.png\"
  nullray render model.glb --flash --beta 0.5 -o light.apng
  nullray render model.glb --beta 0.9 --print-scene > scene.toml

`nullray help render` lists formats and channels.";

pub const FILM: &str = "\
Examples:
  nullray film scene.toml --flyby 0.9
  nullray film scene.toml --accelerate 0.9 --distance \"20 m\" -o start.apng
  nullray film scene.toml --speeds 0.99 --beside rest --caption \"a street\"
  nullray film scene.toml --speeds 0.9 --beside diagram --size 640x360
  nullray film scene.toml --light --from \"5 m\" --to \"12 m\"
  nullray film scene.toml --flyby 0.9 -o - | ffmpeg -i - -pix_fmt yuv420p film.mp4

An .apng plays in every browser. A .y4m is 8-bit YCbCr 4:4:4 by BT.709 in the limited range, for any encoder. The finished \
pictures of a film are kept in FILE.frames until it is complete: to resume after an interruption, run the same command again. \
All pictures share one exposure (--own-exposure gives each its own). It is that of the film's middle third: the scene's \
percentile over small previews, so that a few bright pictures at an end do not leave the others black. With --speeds it is that of \
all pictures, on a logarithmic scale if their own exposures differ by more than a factor of 30. The scene's display.white holds for its own camera, with \
--light; --white R and --set \"display.logarithmic=[1e-6,1e4]\" set the scale of any film.

--time is a time of the scene's own camera, by its clock. --flyby passes the place where that camera is then, at that moment; \
--accelerate and --speeds begin there. --light has --from and --to instead.";

pub const PAGE: &str = "\
Examples:
  nullray page scene.toml -o page
  nullray page scene.toml -o page --beta 0.99 --steps 21 --direction x --title \"A street\"
  nullray page scene.toml -o page --from \"0 m\" --to \"6 m\" --times 7 --steps 7
  nullray page scene.toml -o page --grid 4x3

DIR/index.html holds pictures, diagrams and script in one file and loads nothing else, so that it can be opened from a disk and \
put on any course page. Finished pictures are kept in DIR/index.html.frames until the page is complete.";

pub const SHEET: &str = "\
Examples:
  nullray sheet figure.toml
  nullray sheet figure.toml --size 320x240 --spp 1 -o draft.png
  nullray sheet figure-*.toml --directory pages --keep-panels

The [[panel]] tables of a scene define its panels, and [sheet] its title and columns. A scene without panels is \
rendered as a single panel. Set display.white, or --white, to give all panels the same brightness.";

pub const DIAGRAM: &str = "\
Examples:
  nullray diagram twin-paradox.toml -o twins.svg -o twins.pdf -o twins.png -o twins.tex
  nullray diagram length-contraction.toml --set diagram.frame.0.velocity=0.8 --dark
  nullray diagram scene.toml --frame camera
  nullray diagram twin-paradox.toml --boost-to out -o twins.apng
  nullray diagram twin-paradox.toml --boost-to out -o - | ffmpeg -i - -pix_fmt yuv420p twins.mp4
  nullray diagram twin-paradox.toml --boost-to out --frames 0..72 -o twins-####.svg
  nullray diagram scene.toml --pixel 320,240 -o pixel.svg
  nullray diagram scene.toml --pixel 320,240 --dimensions 2+1 -o cone.pdf

A file may contain nothing but a [diagram] table. For a scene without one, the diagram shows the world lines of the camera and \
the objects, the pulses with their light, and the light by which the camera sees the objects at its time. Meshes \
and cubes are not read.

--pixel draws the light that reaches one pixel, from emission to reception: the clocks of camera and object, \
where the object is seen, and where it is now. This loads the scene's geometry.";

pub const EXPORT: &str = "\
Examples:
  nullray export scene.toml -o bundle
  nullray export scene.toml --size 640x480 -o bundle --overwrite
  nullray export figure.toml --panel beta-0.9 --no-reference -o bundle

The directory holds GLB files, bundle.json with its JSON schema, cubes, reference pictures with all auxiliary \
channels (one ray through each pixel's centre, whatever --spp says), and README.md, which tells authors of \
other renderers how to read it and how to compare. A directory that is not an export is never replaced.";

pub const BAKE: &str = "\
Examples:
  nullray bake scene.toml --camera --bin-width \"5 cm\" --bins 200 --bounces 4 --spp 256 -o light.npy
  nullray bake scene.toml --object floor --texels 512x512 --bin-width \"5 cm\" --bins 1000 --plan
  nullray bake scene.toml --object floor --texels 128x128 --bin-width \"5 cm\" --error \"5 %\" -o floor.npy

Each sample is a path over `render.bounces` surfaces after the first; its light is added to every time bin in which it arrives. \
`bake` prints the [[source]] table with which a scene reads the file, and how much of the energy the bins miss: if that is much, \
move --start, or give more or wider bins.";

pub const CONVERT: &str = "\
Examples:
  nullray convert capture.npz -o frames
  nullray convert frames --axes \"T H W\" -o capture.npy --type f16
  nullray convert capture.npy -o small.npz --rows 0:64 --columns 0:64 --merge 2
  nullray convert capture.npy --unwarp seen.npz --bin-width \"0.05 m\" --start \"7 m\" -o world.npy

Files larger than memory are converted in parts; archives and pictures are unpacked to a temporary file first. \
To make a picture of distances, render the scene as the capture camera sees it: \
nullray render scene.toml --aovs distance --pixel-centers -o seen.npz. Where a shift splits a bin, its energy is divided between \
the two bins that it reaches, so that sums stay the same. Outputs appear once they are complete.";

pub const MESH_FROM_DEPTH: &str = "\
Examples:
  nullray mesh-from-depth capture.npz --eye 3.2,3,4.6 --look-at -0.4,1,-0.6 --fov \"45 deg\" --start \"7.2 m\" --bin-width \"0.05 m\" --lamp 1.2,2.8,1 -o wall.glb
  nullray mesh-from-depth seen.npz --from distance --eye 0,1,5 --look-at 0,0,0 --fov \"60 deg\" -o seen.glb

There is a vertex at the centre of each pixel, with the texture coordinates of that place in the picture. If a cube of the same \
camera holds times of emission, use `uv = 0`; if it holds times of arrival, use `capture` with the same camera. The mesh is torn \
where one surface ends \
in front of another. The distance is that of the light that came first, straight from the surface. Dark pixels are left out (--dark-fraction): \
where only indirect light arrives, the distance would be too long.";

pub const STUDY: &str = "\
Examples:
  nullray study scene.toml
  nullray study scene.toml --size 320x240 --samples 1,16 --budget 20 -o study.csv -o study.png
  nullray study scene.toml --methods \"trace; raster:uniform=0.1; raster:adaptive=0.1\" --runs 21

The methods run in turn, and the median time is reported. Errors are measured in geometry (how far each visible \
point is from where it should be, in pixels), in emission times, and in radiance, against a ray-traced picture with many \
samples. --samples sets the number of samples; --spp is ignored. On a busy machine, trust ratios rather than times.";

/// Examples, the metrics and exit codes.
pub fn compare() -> String {
    format!(
        "{COMPARE}\n{}\n\n{COMPARE_EXIT}",
        nullray::validate::compare::help()
    )
}

const COMPARE: &str = "\
Examples:
  nullray compare exact.exr mine.exr --report report.html
  nullray compare exact.npz mine.npz --bin-width \"5 mm\" --json
  nullray compare exact.exr mine.exr --tolerance rmse=0.01 --tolerance geometric.p99=0.1

Channels are matched by name. Metrics of --tolerance:";

const COMPARE_EXIT: &str = "Exit codes: 0 within all tolerances; 1 a tolerance is exceeded, or too little could be measured to judge it; 2 bad input.";

pub const PLAN: &str = "\
Examples:
  nullray plan scene.toml --size 1920x1080 --aovs event
  nullray plan scene.toml --json";

pub const TESSELLATION: &str = "\
Examples:
  nullray tessellation scene.toml --pixels 0.5
  nullray tessellation scene.toml --pixels 0.1 --json

A rasterizer moves vertices to their apparent positions and joins them by straight edges, although the true edges \
are curved. For each visible object this prints: the greatest length that its edges may have, in its rest frame, to keep \
every point within --pixels of its true position; how many parts its longest edge has to be cut into, or how many times \
halved; the largest error without any cuts; and the triangle and the pixel that need the shortest edges.";

pub const INFO: &str = "\
For a mesh: triangles, materials, nodes, cameras. For arrays: shape, type, and whether they can be used as \
time-resolved radiance. For pictures: size, channels with their ranges, metadata. For a scene: camera, \
objects, sources. The samples of arrays are checked; of large arrays, a part of them.";

pub const SELFTEST: &str = "\
Each line tests one regime near the limits of f64: the worst error found, the derived bound, the unit, and the \
number of cases. eps is 2^-53; the conditioning is the factor by which rounding of the input is amplified.

Exit codes: 0 all checks hold; 1 a check fails.";

/// Examples, formats and the table of channels.
pub fn render_long() -> String {
    // The short help ends with where to find the long one, which is this.
    let mut text = format!(
        "{}\n{SEQUENCES}\n{METHODS}\n{FORMATS}",
        RENDER
            .rsplit_once("\n\n")
            .map_or(RENDER, |(examples, _)| examples)
    );
    for aov in Aov::ALL {
        let _ = write!(text, "\n  {:<21}{}", aov.name(), aov.meaning());
    }
    text + "\n\n" + SAMPLES
}

const SEQUENCES: &str = "
Sequences: --frames, or --from and --to, write one picture per frame. A run of # in the file name \
(\"frame-####.png\"), or %04d as in C, is replaced by the frame number; without one the number goes before the extension. Frame k is \
numbered k whatever part of the sequence is rendered, so two machines can render 0..50 and 50..100 of the same \
sequence. Frames whose files are already complete, from the same version, scene and options, are skipped: to \
resume after an interruption, run the same command again.

Films: -o FILE.apng (animated PNG) or FILE.y4m (raw video: 8-bit YCbCr 4:4:4, BT.709, limited range; - for standard output) joins \
the frames of a sequence, --play-fps of them a second. With `-o -`, pictures go to standard output as they are rendered; messages go to standard error. Unless -o also \
names a .png, the frames of a file are kept in FILE.frames until the film is complete, so that it can be resumed.

Panels: a scene with [[panel]] tables is rendered panel by panel, with the panel's name added before the \
extension. With a single --panel and -o, the file name is used as given.";

const METHODS: &str = "
Methods (--method): all but the first approximate geometry and visibility. Samples, radiance and channels are \
defined alike.
  trace                     rays; exact
  raster:none               vertices at their apparent positions, flat triangles between them
  raster:uniform=0.05       the same, triangles cut until no edge is longer than 0.05 m in its rest frame
  raster:adaptive=0.5       the same, cut until no point is more than 0.5 pixels off
  warp:cube=1024            a picture from the same event at rest, looked up by direction: a cube with faces of \
1024² texels (objects at rest only)
  warp:panorama=2048x1024   the same, by longitude and latitude
With ,attributes=vertex emission times and wavelength ratios of rasterizers are interpolated between vertices instead of \
computed at each sample; with ,lookup=nearest warps take the nearest texel instead of interpolating.";

const FORMATS: &str = "
Formats, by the extension of -o:
  .png   for displays: sRGB, tone-mapped by --exposure or --white
  .exr   linear, single precision: R, G, B are the radiance; auxiliary channels by their names, but distance as Z and
         alpha as A; --half for radiance and alpha in half precision
  .npz   for numpy, double precision: array `radiance` (rows, columns, 3), one array per channel
All hold the scene's text, its SHA-256, version, camera and units as metadata.

Auxiliary channels (--aovs), alone or by group (`event` is event.ct, event.x, event.y, event.z):";

const SAMPLES: &str = "\
Object, primitive, barycentric and uv come from the sample nearest to the pixel's centre; the other channels \
are averages. With --pixel-centers all come from the ray through the centre. Where a ray hits nothing, surface \
channels are NaN, and object and primitive are -1.";
