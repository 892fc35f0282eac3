//! Commands and their options → completions for shells, manual pages.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Command, Parser};
use clap_complete::Shell;

use crate::output::Pending;
use crate::report;

/// Options of `rocking completions`.
#[derive(Parser)]
pub struct Completions {
    /// Shell, as in `rocking completions bash > ~/.local/share/bash-completion/completions/rocking`
    #[arg(value_enum)]
    shell: Shell,
}

/// Options of `rocking man`.
#[derive(Parser)]
pub struct Man {
    /// Folder for a page on each command, created if missing; without it the main page is printed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Prints the completion script of a shell.
pub fn completions(options: &Completions, mut command: Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut command, "rocking", &mut script);
    report::print(&String::from_utf8(script)?, false)
}

/// Prints the main manual page, or writes the pages of all commands.
pub fn man(options: &Man, command: Command) -> anyhow::Result<()> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let Some(folder) = &options.out else {
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page)?;
        return report::print(&String::from_utf8(page)?, false);
    };
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    let mut pages = Vec::new();
    let mut commands = vec![command];
    while let Some(command) = commands.pop() {
        commands.extend(command.get_subcommands().cloned());
        let man = clap_mangen::Man::new(command);
        let mut page = Vec::new();
        man.render(&mut page)?;
        pages.push((Pending::new(&folder.join(man.get_filename()))?, page));
    }
    Pending::write(pages)?;
    report::print(&format!("written       {}\n", folder.display()), false)
}
