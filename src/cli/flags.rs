//! The library's messages say what to set by the names that it has there; here they become the program's flags.

use nullray::Error;

/// What the library says, and what sets it on the command line.
const FLAGS: [(&str, &str); 15] = [
    ("a higher `memory_limit`", "a higher limit (--max-memory)"),
    ("`allow_outside`", "--allow-outside"),
    ("`allow_swapped`", "--allow-swapped"),
    ("`overwrite`", "--overwrite"),
    ("`vectors`", "--vectors"),
    (
        "trace it with `render::render`",
        "render it by --method trace",
    ),
    ("`NotFinite::Ignore`", "--nan ignore"),
    ("`NotFinite::CountAs(0.0)`", "--nan count-as=0"),
    (
        "is read as `Encoding::Linear`",
        "is read with --transfer linear",
    ),
    ("`channels` of \"radiance\"", "--channels radiance"),
    ("which `channels` demands", "which --channels demands"),
    (
        "`Coordinates::Atlas`, which makes some",
        "--atlas, which makes coordinates",
    ),
    ("or `camera_cube`", "or --camera"),
    ("a `size` of ", "--texels "),
    ("tolerance of ", "--tolerance "),
];

/// The same error with flags for the names of fields.
pub fn with_flags(mut error: Error) -> Error {
    if let Error::Invalid(problem) | Error::Unsupported(problem) = &mut error {
        for text in [&mut problem.place, &mut problem.what, &mut problem.help] {
            for (field, flag) in FLAGS {
                if text.contains(field) {
                    *text = text.replace(field, flag);
                }
            }
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_the_library_become_flags() {
        let help = "a smaller file, or a higher `memory_limit`";
        let error = with_flags(Error::invalid("a.glb", "memory", "too large", help));
        assert_eq!(
            error.help(),
            "a smaller file, or a higher limit (--max-memory)"
        );
        let other = "a key of the scene: `channels`";
        assert_eq!(
            with_flags(Error::unsupported("a", "", "", other)).help(),
            other
        );
    }
}
