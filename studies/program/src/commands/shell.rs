//! Commands and their options → completions for shells, manual pages, a reference in Markdown.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Arg, Command, Parser};
use clap_complete::Shell;

use crate::output::files::Pending;
use crate::output::report;

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
    /// Print all commands and options as one page of Markdown
    #[arg(long, conflicts_with = "out")]
    markdown: bool,
}

/// Prints the completion script of a shell.
pub fn completions(options: &Completions, mut command: Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut command, "rocking", &mut script);
    report::print(&String::from_utf8(script)?, false)
}

/// Prints the main manual page or the reference in Markdown. With a folder it writes the pages of all commands.
pub fn man(options: &Man, command: Command) -> anyhow::Result<()> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    if options.markdown {
        return report::print(&markdown(&command), false);
    }
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

/// Describes a command, its options by heading, and its subcommands.
fn markdown(command: &Command) -> String {
    let name = command.get_display_name().unwrap_or(command.get_name()).replace('-', " ");
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let level = "#".repeat(name.split(' ').count());
    let usage = command.clone().render_usage().to_string().replace("Usage: ", "").replace("\n       ", "\n    ");
    let mut page = format!("{level} {name}\n\n{about}\n\n    {usage}\n");
    let arguments =
        command.get_arguments().filter(|arg| !arg.is_hide_set() && arg.get_id() != "help" && arg.get_id() != "version");
    // As in the help: positional arguments first, then the headings in the order of their first options.
    let mut groups: Vec<(&str, String)> = Vec::new();
    let (positional, options): (Vec<_>, Vec<_>) = arguments.partition(|arg| arg.is_positional());
    for arg in positional.into_iter().chain(options) {
        let heading = if arg.is_positional() { "Arguments" } else { arg.get_help_heading().unwrap_or("Options") };
        match groups.iter_mut().find(|(name, _)| *name == heading) {
            Some((_, rows)) => *rows += &row(arg),
            None => groups.push((heading, row(arg))),
        }
    }
    for (heading, rows) in groups {
        page += &format!("\n**{heading}**\n\n| option | meaning | default |\n| --- | --- | --- |\n{rows}");
    }
    for subcommand in command.get_subcommands() {
        page += &format!("\n{}", markdown(subcommand));
    }
    page
}

/// Describes an option as a row of a table.
fn row(arg: &Arg) -> String {
    let plain = |text: &dyn ToString| text.to_string().replace('\n', " ").replace('|', "\\|").replace('<', "&lt;");
    let mut help = arg.get_long_help().or(arg.get_help()).map(|text| plain(text)).unwrap_or_default();
    let mut default =
        arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect::<Vec<_>>().join(" ");
    // A specification leaves out what a user did not give; its help states the default.
    if let Some((meaning, stated)) = help.strip_suffix(']').and_then(|help| help.split_once(" [default: ")) {
        (help, default) = (meaning.into(), stated.into());
    }
    let takes_value = arg.get_action().takes_values();
    for value in if takes_value { arg.get_possible_values() } else { Vec::new() } {
        let meaning = value.get_help().map(|text| format!(": {}", plain(text))).unwrap_or_default();
        help += &format!("<br>`{}`{meaning}", value.get_name());
    }
    let default = if takes_value && !default.is_empty() { format!("`{default}`") } else { default };
    format!("| `{}` | {help} | {default} |\n", arg.to_string().replace('|', "\\|"))
}
