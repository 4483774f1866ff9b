//! What the help says beyond the options; the man pages too.

use std::fmt::Write;

use nullray::render::aov::Aov;

pub const PROGRAM: &str = "\
Examples:
  nullray                            render the built-in scene into nullray-out/
  nullray render scene.toml          write scene.png
  nullray sheet scene.toml           write its panels on one labelled page, scene-sheet.png
  nullray diagram scene.toml         draw its world lines, scene.svg
  nullray export scene.toml -o DIR   write it for other renderers, with reference pictures
  nullray study scene.toml           measure run time against error, by several methods
  nullray plan scene.toml            see what that would need, before
  nullray info data.npz              see what a file holds
  nullray selftest                   test this build on this machine
  nullray help render                all options, examples and channel names

Exit codes: 0 done; 1 a self-test that fails, or a comparison beyond a tolerance; 2 wrong arguments, bad input, or a file that cannot be read or written; \
101 a bug of this program; 130 stopped by Ctrl-C, with no unfinished file left.

No environment variable changes what is computed; NO_COLOR turns the colours of messages off.";

pub const RENDER: &str = "\
Examples:
  nullray render scene.toml -o still.png -o data.exr --aovs all
  nullray render scene.toml --time \"2 ns\" --set \"camera.velocity={beta=[0,0,-0.5]}\"
  nullray render scene.toml --size 320x240 --spp 1 --isochrones times.png
  nullray render scene.toml --overlay figure.pdf --overlay-parts outlines,beta
  nullray render scene.toml --from \"0 ns\" --to \"10 ns\" --fps 5e9 --white 0.5 -o \"frame-####.png\"
  nullray render scene.toml --frames 50..100 --interval \"2 cm\" -o film.exr
  nullray render figure.toml --panel beta-0.9 -o right.png

`nullray help render` tells of formats and channels.";

pub const SHEET: &str = "\
Examples:
  nullray sheet figure.toml
  nullray sheet figure.toml --size 320x240 --spp 1 -o draft.png
  nullray sheet figure-*.toml --directory pages --keep-panels

A scene's [[panel]] tables say what its panels are, [sheet] the title and the columns; a scene without \
panels is one panel of its own name. Give display.white, or --white, for panels that are equally bright.";

pub const DIAGRAM: &str = "\
Examples:
  nullray diagram twin-paradox.toml -o twins.svg -o twins.pdf -o twins.png
  nullray diagram twin-paradox.toml --set \"diagram.event.turn.at=[5,4]\" --dark
  nullray diagram scene.toml --frame camera
  nullray diagram twin-paradox.toml --boost-to out -o twins.apng
  nullray diagram twin-paradox.toml --boost-to out --frames 0..49 -o twins-####.svg
  nullray diagram scene.toml --pixel 320,240 -o pixel.svg
  nullray diagram scene.toml --pixel 320,240 --dimensions 2+1 -o cone.pdf

A file may hold a [diagram] table alone. Without one the diagram shows the world lines of the camera and the \
objects, the pulses with their light, and the light by which the camera sees the objects at its time. No mesh \
and no cube is read.

--pixel draws the light that one pixel sees, from its emission to its reception, along the ray: clocks of camera \
and object, where the object was seen and where it is now. The scene's geometry is loaded for it.";

pub const EXPORT: &str = "\
Examples:
  nullray export scene.toml -o bundle
  nullray export scene.toml --size 640x480 -o bundle --overwrite
  nullray export figure.toml --panel beta-0.9 --no-reference -o bundle

The directory holds GLB files, bundle.json with its JSON schema, cubes, reference pictures with all auxiliary \
channels (one ray through each pixel's centre, whatever --spp says), and README.md, which tells the author of \
another renderer how to read it and how to compare. A directory that is no export is never replaced.";

pub const STUDY: &str = "\
Examples:
  nullray study scene.toml
  nullray study scene.toml --size 320x240 --samples 1,16 --budget 20 -o study.csv -o study.png
  nullray study scene.toml --methods \"trace; raster:uniform=0.1; raster:adaptive=0.1\" --runs 21

Runs of all methods take turns, and the median counts. Errors are those of geometry (where each point that is \
shown should have been, in pixels), of emission times, and of radiance against a picture of the ray tracer with many \
samples. The number of samples is that of --samples, whatever --spp says. On a machine that does other things too, \
trust ratios rather than times.";

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

const COMPARE_EXIT: &str = "Exit codes: 0 within all tolerances, 1 beyond one, 2 bad input.";

pub const PLAN: &str = "\
Examples:
  nullray plan scene.toml --size 1920x1080 --aovs event
  nullray plan scene.toml --json";

pub const TESSELLATION: &str = "\
Examples:
  nullray tessellation scene.toml --pixels 0.5
  nullray tessellation scene.toml --pixels 0.1 --json

Rasterizers move vertices to where they are seen and join them by straight edges, which are curved. For each \
object that the picture shows: how long its edges may be, in its rest frame, so that no point is drawn farther \
than that from its place, along edges or across; into how many parts its longest edge has to be cut, or how often \
halved; how far points may be off as it is; and the triangle and the pixel that need the shortest edges.";

pub const INFO: &str = "\
Of a mesh: triangles, materials, nodes, cameras. Of arrays: shape, type, and whether they can be used as \
time-resolved radiance. Of pictures: size, channels with their ranges, metadata. Of a scene: camera, \
objects, sources. Only headers are read, except of .exr.";

pub const SELFTEST: &str = "\
Each line is a regime at the ends of f64: the worst error found, the bound that is derived for it, in which \
unit, and in how many cases. eps is 2^-53; the conditioning says how much rounding the input itself counts.

Exit codes: 0 all hold; 1 one fails.";

/// Examples, formats and the table of channels.
pub fn render_long() -> String {
    let mut text = format!(
        "{}\n{SEQUENCES}\n{METHODS}\n{FORMATS}",
        RENDER
            .rsplit_once("\n\n")
            .map_or(RENDER, |(examples, _)| examples)
    );
    for aov in Aov::ALL {
        let _ = write!(text, "\n  {:<17}{}", aov.name(), aov.meaning());
    }
    text + "\n\n" + SAMPLES
}

const SEQUENCES: &str = "
Sequences: with --frames, or --from and --to, a picture of each frame is written. A run of # in the name \
(\"frame-####.png\") becomes its number; without one the number stands before the extension. Frame k is \
numbered k whatever part of the sequence is rendered, so that 0..50 and 50..100, on two machines, are one \
sequence. A frame whose files are there, whole and made by the same request of the same version from the \
same input, is not rendered again: after an interruption the same command goes on.

Panels: a scene with [[panel]] tables is rendered panel by panel, with the panel's name before the \
extension; with one --panel and -o the name is taken as it is.";

const METHODS: &str = "
Methods (--method): all but the first approximate geometry and visibility, with samples, radiance and channels \
of the same definition.
  trace                     rays; exact
  raster:none               vertices at their apparent positions, flat triangles between them
  raster:uniform=0.05       the same, triangles cut until no edge is longer than 0.05 m in its rest frame
  raster:adaptive=0.5       the same, cut until no point is more than 0.5 pixels off
  warp:cube=1024            directions looked up in what is met from the same event at rest: a cube with faces of \
1024² texels (objects at rest only)
  warp:panorama=2048x1024   the same, by longitude and latitude
With ,attributes=vertex emission times and wavelength ratios of rasterizers are interpolated between vertices, not \
worked out at each sample; with ,lookup=nearest warps take the nearest texel, not the four around.";

const FORMATS: &str = "
Formats, by the extension of -o:
  .png   for displays: sRGB, tone-mapped by --exposure or --white
  .exr   linear, single precision: R, G, B are the radiance; auxiliary channels by their names
  .npz   for numpy, double precision: array `radiance` (rows, columns, 3), one array per channel
All hold the scene's text, its SHA-256, version, camera and units as metadata.

Auxiliary channels (--aovs), alone or by group (`event` is event.ct, event.x, event.y, event.z):";

const SAMPLES: &str = "\
Object, primitive, barycentric and uv are those of the sample nearest to the pixel's centre; the others \
are means. --pixel-centers makes all of them those of the ray through the centre. Where nothing is met \
those of surfaces hold NaN, and -1 for object and primitive.";
