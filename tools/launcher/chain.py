"""The steps of the chain, in the order in which a user takes them, and the tools of each."""

HEADINGS = {
    "image": "Make or look at an image",
    "sample": "Make a sample",
    "plan": "Plan and calibrate",
    "run": "Run",
    "surface": "Surfaces and pores",
    "measure": "Measures of a run",
    "picture": "Pictures, pages and files for other programs",
    None: "Other tools",  # those that declare no step
}


def sorted_by_step(tools):
    """The descriptions of tools (see list_tools) in the order of the chain; by name within a step."""
    order = list(HEADINGS)
    return sorted(tools, key=lambda tool: (order.index(tool["step"]), tool["name"]))


def by_step(tools):
    """Pairs of a heading and the descriptions of its tools, without the steps that have none."""
    steps = [(heading, [tool for tool in sorted_by_step(tools) if tool["step"] == step])
             for step, heading in HEADINGS.items()]
    return [(heading, members) for heading, members in steps if members]
