"""The templates of the page; what they show is escaped."""
import importlib.resources

import jinja2
import markupsafe


def own_text(name):
    return importlib.resources.files("assets").joinpath(name).read_text(encoding="utf-8")


def filled(template, /, **values):
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda one: own_text(f"templates/{one}")), autoescape=True, trim_blocks=True,
        lstrip_blocks=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    return environment.get_template(template).render(**values)


def as_it_is(text):
    """Of our own or of another program's making: style, script, a drawing."""
    return markupsafe.Markup(text)
