//! `nullray schema`, `completions`, `man`: made from the definitions that the program itself uses.

use std::path::Path;

use clap::CommandFactory;
use nullray::io::image::write_atomically;
use nullray::{Error, Result};

use super::args::Arguments;
use super::console::print;

/// The scene file's JSON schema.
pub fn schema() -> Result<()> {
    print(&format!("{:#}\n", nullray::scene::schema()))
}

/// Completions for `shell`.
pub fn completions(shell: clap_complete::Shell) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "nullray", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// The manual: the main page on standard output, or a page per command in `directory`.
pub fn man(directory: Option<&Path>) -> Result<()> {
    let mut command = Arguments::command();
    command.build();
    let Some(directory) = directory else {
        return print(&String::from_utf8_lossy(&page(command)?));
    };
    std::fs::create_dir_all(directory)
        .map_err(Error::io(directory, "cannot create the directory"))?;
    let subcommands: Vec<_> = command.get_subcommands().cloned().collect();
    write(directory, "nullray", command)?;
    for subcommand in subcommands.into_iter().filter(|c| c.get_name() != "help") {
        // "nullray-render", as clap names the built subcommand.
        let name = subcommand
            .get_display_name()
            .unwrap_or("nullray")
            .to_string();
        write(directory, &name, subcommand)?;
    }
    Ok(())
}

fn write(directory: &Path, name: &str, command: clap::Command) -> Result<()> {
    let path = directory.join(format!("{name}.1"));
    let text = page(command)?;
    write_atomically(&path, |file| {
        std::io::Write::write_all(file, &text).map_err(Error::io(&path, "cannot write"))
    })?;
    print(&format!("wrote {}\n", path.display()))
}

fn page(command: clap::Command) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut text)
        .map_err(Error::io("manual page", "cannot write"))?;
    Ok(text)
}
