"""Repository → site: pages outside docs, generated references, links, formulas and diagrams."""

import ast
import html
import os
import re
import subprocess
import tomllib
import xml.etree.ElementTree as ET
from itertools import groupby
from pathlib import Path, PurePosixPath

import mermaidx
from latex2mathml.converter import convert
from markdown.extensions import Extension
from markdown.treeprocessors import Treeprocessor
from mkdocs.structure.files import File
from pymdownx.slugs import slugify
from pymdownx.superfences import SuperFencesException

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("ROCKING_BLOCK_PROGRAM", ROOT / "target/release/rocking"))
# Pages and files outside docs that belong to the site, under their paths in the repository.
ADDED = ("CHANGELOG.md", "CONTRIBUTING.md", "LICENSE-APACHE", "LICENSE-MIT", "lab/benches/peers", "examples")
DOCUMENTATION = PurePosixPath("docs")
# Files of the repository that another page of the site shows.
SHOWN = {PurePosixPath("README.md"): PurePosixPath("README.md"), PurePosixPath("modelDescription.xml"): PurePosixPath("reference/fmu.md")}


def tracked(*paths):
    listed = subprocess.run(["git", "ls-files", "--", *paths], cwd=ROOT, capture_output=True, text=True, check=True)
    return [PurePosixPath(line) for line in listed.stdout.splitlines()]


def in_repository(src_uri):
    """Returns the path of a page of the site in the repository."""
    path = PurePosixPath(src_uri)
    return path if path in ADDED_PATHS else DOCUMENTATION / path


ADDED_PATHS = set(tracked(*ADDED))


def on_config(config):
    with open(ROOT / "Cargo.toml", "rb") as file:
        package = tomllib.load(file)["workspace"]["package"]
    config.extra["version_text"] = package["version"]
    config.repo_url = package.get("repository")
    fences = [{"name": "math", "class": "math", "format": formula}, {"name": "mermaid", "class": "diagram", "format": diagram}]
    config.markdown_extensions += ["pymdownx.superfences", "pymdownx.highlight", Links(config)]
    config.mdx_configs.setdefault("toc", {})["slugify"] = slugify(case="lower")
    config.mdx_configs["pymdownx.superfences"] = {"custom_fences": fences}
    config.mdx_configs["pymdownx.highlight"] = {"default_lang": "text"}
    return config


def on_files(files, config):
    for path in sorted(ADDED_PATHS):
        if path.suffix != ".xml":
            files.append(File.generated(config, str(path), abs_src_path=str(ROOT / path)))
    for name, content in {"program": program_reference(), "python": python_reference(), "fmu": fmu_reference()}.items():
        files.append(File.generated(config, f"reference/{name}.md", content=content))
    for name in ("style.css", "math.woff2", "search_frame.js"):
        files.append(File.generated(config, name, abs_src_path=str(Path(__file__).with_name(name))))
    return files


def on_page_markdown(markdown, page, config, files):
    Links.page, Links.files = page, files
    return markdown


def on_post_page(output, page, config):
    """Has a page opened from a disk load the worker of its search from there."""
    shim = os.path.relpath("search_frame.js", PurePosixPath(page.file.dest_uri).parent)
    return output.replace("https://unpkg.com/iframe-worker/shim", shim)


class Links(Extension):
    """Turns links between files of the repository into links of the site."""

    page = files = None

    def __init__(self, config):
        super().__init__()
        self.config_of_site = config

    def extendMarkdown(self, md):
        # MkDocs resolves the links that this leaves, with priority 0.
        processor = LinkProcessor(md)
        processor.site = self.config_of_site
        md.treeprocessors.register(processor, "repository_links", 5)


class LinkProcessor(Treeprocessor):
    site = None

    def run(self, root):
        for element in root.iter():
            for attribute in ("href", "src"):
                if attribute in element.attrib:
                    self.rewrite(element, attribute)

    def rewrite(self, element, attribute):
        target, _, anchor = element.get(attribute).partition("#")
        if not target or ":" in target or target.startswith("/"):
            return
        uri = Links.page.file.src_uri
        path = PurePosixPath(os.path.normpath(in_repository(uri).parent / target))
        inside = SHOWN.get(path) or (path.relative_to(DOCUMENTATION) if path.is_relative_to(DOCUMENTATION) else path)
        if Links.files.get_file_from_path(str(inside)):
            element.set(attribute, os.path.relpath(inside, PurePosixPath(uri).parent) + (f"#{anchor}" if anchor else ""))
        elif attribute == "href" and (ROOT / path).exists():
            if self.site.repo_url:
                element.set("href", f"{self.site.repo_url}/blob/v{self.site.extra['version_text']}/{path}")
            else:
                # A file that only a clone has.
                element.tag = "span"
                element.attrib = {"title": f"{path} in the repository"}


def formula(source, language, css_class, options, md, **_):
    """Renders a fence of TeX, one formula a line, as MathML."""
    try:
        lines = [convert(line, display="block") for line in source.splitlines() if line.strip()]
    except Exception as error:
        raise SuperFencesException(f"no formula: {source}") from error
    return f'<div class="{css_class}">{"".join(lines)}</div>'


def diagram(source, language, css_class, options, md, **_):
    """Renders a fence of Mermaid as SVG."""
    try:
        drawn = mermaidx.render(source, theme="neutral").svg()
    except Exception as error:
        raise SuperFencesException(f"no diagram: {source}") from error
    return f'<div class="{css_class}">{drawn}</div>'


def program_reference():
    """Prints the commands and their options, as clap has them."""
    return subprocess.run([PROGRAM, "man", "--markdown"], capture_output=True, text=True, check=True).stdout


def python_reference():
    """Lists the public names of the package for mkdocstrings, which reads their docstrings."""
    source = ROOT / "studies/python/rocking_block/__init__.py"
    tree = ast.parse(source.read_text())
    names = next(ast.literal_eval(node.value) for node in tree.body
                 if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    page = "# Python package\n\nThe public names of `rocking_block`, from their docstrings. [The guide](../studies/python.md) shows how they work together.\n"
    for title, chosen in {
        "Functions": [name for name in names if name.islower() and name != "foundations"],
        "Classes": [name for name in names if not name.islower()],
        "Foundations": ["foundations"],
    }.items():
        page += f"\n## {title}\n\n" + "".join(f"::: rocking_block.{name}\n\n" for name in sorted(chosen))
    return page


CAUSALITIES = {
    "input": "Inputs",
    "parameter": "Parameters",
    "output": "Outputs",
    "calculatedParameter": "Calculated parameters",
    "local": "Local variables",
    "independent": "Independent variable",
}


def fmu_reference():
    """Tabulates the variables of modelDescription.xml."""
    root = ET.parse(ROOT / "modelDescription.xml").getroot()
    variables = [(variable, variable[0]) for variable in root.iter("ScalarVariable")]
    page = ("# Variables of the FMU\n\nFrom `modelDescription.xml`, which defines both FMUs. [Importers](../unit/importing.md) explains the "
            "settings that matter. Where no start value is given, the variable is calculated.\n")
    order = list(CAUSALITIES)
    variables.sort(key=lambda entry: order.index(entry[0].get("causality", "local")))
    for causality, group in groupby(variables, lambda entry: entry[0].get("causality", "local")):
        page += f"\n## {CAUSALITIES[causality]}\n\n| name | unit or type | start | limits | description |\n| --- | --- | --- | --- | --- |\n"
        for variable, kind in group:
            declared = kind.get("declaredType", "")
            type_name = kind.get("unit") or (f"[{declared}](#choices)" if kind.tag == "Enumeration" else kind.tag)
            limits = " to ".join(kind.get(limit, "") for limit in ("min", "max")) if "min" in kind.attrib or "max" in kind.attrib else ""
            description = html.escape(variable.get("description", ""), quote=False).replace("|", "\\|")
            page += f"| `{variable.get('name')}` | {type_name} | {kind.get('start', '')} | {limits} | {description} |\n"
    page += "\n## Choices\n\nIntegers in FMI 2.0, Enumerations in FMI 3.0.\n\n| type | value | name | meaning |\n| --- | ---: | --- | --- |\n"
    for simple_type in root.iter("SimpleType"):
        for item in simple_type.iter("Item"):
            page += f"| {simple_type.get('name')} | {item.get('value')} | `{item.get('name')}` | {item.get('description')} |\n"
    return page
