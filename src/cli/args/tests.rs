use clap::CommandFactory;
use clap::error::ErrorKind;

use super::*;

/// The names of values that are no numbers; those of files are "FILE" and its endings.
const WORDS: [&str; 19] = [
    "AOVS",
    "AXES",
    "AXIS",
    "D",
    "DIR",
    "HOW",
    "KEY=VALUE",
    "LIST",
    "METHOD",
    "METRIC=VALUE",
    "NAME",
    "NAMES",
    "POLICY",
    "SHELL",
    "TEXT",
    "TYPE",
    "WHAT",
    "WHERE",
    "certified|fast",
];

#[test]
fn a_number_below_0_is_the_value_of_its_option_and_not_another_option() {
    let program = Arguments::command();
    let (mut tried, mut refused) = (0, Vec::new());
    for command in program.get_subcommands() {
        for option in command.get_opts() {
            let value = option
                .get_value_names()
                .map_or("", |names| names[0].as_str());
            if !option.get_action().takes_values()
                || WORDS.contains(&value)
                || value.starts_with("FILE")
            {
                continue;
            }
            let Some(name) = option.get_long() else {
                continue;
            };
            let name = format!("--{name}");
            for number in ["-1", "-1 %", "-1 s"] {
                // Those without a unit are whole numbers, or numbers.
                if number != "-1" && option.is_allow_negative_numbers_set() {
                    continue;
                }
                let words = ["nullray", command.get_name(), &name, number];
                let kind = program.clone().try_get_matches_from(words).err();
                let kind = kind.map(|error| error.kind());
                if kind == Some(ErrorKind::UnknownArgument) {
                    refused.push(words.join(" "));
                }
                tried += 1;
            }
        }
    }
    assert_eq!(refused, Vec::<String>::new());
    assert!(tried > 100, "{tried}");
}
