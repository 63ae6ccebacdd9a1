#include "core/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/polynomial.hpp"
#include "core/base/toml_reader.hpp"
#include "core/base/units.hpp"
#include "core/scene/unusual_values.hpp"

namespace tomodem {
namespace {

/// As errors name it.
std::string scene_called(const std::string& file) {
    return fmt::format("scene '{}'", file);
}

/// Radii of a normal distribution, cut at three standard deviations: beyond this the smallest would vanish.
constexpr double max_dispersion = 0.3;

Norton read_norton(TomlReader reader) {
    Norton norton;
    norton.consistency = reader.optional_positive("K").value_or(0.0);
    norton.rate_sensitivity = reader.optional_positive("M").value_or(0.0);
    if (norton.consistency == 0.0 || norton.rate_sensitivity == 0.0)
        reader.fail(reader.line(), "norton needs both K [MPa.s^M] and M, such as norton = { K = 95.9, M = 2.45e-3 }");
    if (norton.rate_sensitivity > 1) reader.fail(reader.line(), "M in norton is above 1");
    reader.refuse_unknown();
    return norton;
}

Hardening read_hardening(TomlReader reader) {
    Hardening hardening;
    const auto fail_table = [&](const toml::node& node) {
        reader.fail(node,
                    "table of hardening must be a list of [time, factor] such as [[0, 1], [600, 1.2]], times rising, "
                    "factors above 0");
    };
    if (const toml::node* table = reader.find("table")) {
        if (!table->is_array() || table->as_array()->empty()) fail_table(*table);
        for (const toml::node& row : *table->as_array()) {
            const toml::array* const pair = row.as_array();
            if (pair == nullptr || pair->size() != 2) fail_table(row);
            const double time = reader.quantity(*pair->get(0), "time"),
                         factor = reader.quantity(*pair->get(1), "factor");
            const bool rising = hardening.table.empty() || time > hardening.table.back()[0];
            if (!rising || !(factor > 0) || !std::isfinite(factor)) fail_table(row);
            hardening.table.push_back({time, factor});
        }
    } else {
        const auto constant = [&](const char* key, double& value) { value = reader.quantity(reader.get(key), key); };
        constant("amplitude", hardening.amplitude);
        constant("rate", hardening.rate);
        constant("exponent", hardening.exponent);
        constant("base", hardening.base);
        if (const toml::node* offset = reader.find("offset"))
            hardening.offset = reader.quantity(*offset, "offset", units::time);
        if (!(hardening.factor(0) > 0))
            reader.fail(reader.line(), "the factor of hardening is not above 0 at the start");
    }
    reader.refuse_unknown();
    return hardening;
}

const Law* read_law(TomlReader& reader) {
    const toml::node& node = reader.get("law");
    if (const Law* law = find_law(*reader.optional_text("law"))) return law;
    std::string names;
    for (const Law* law : laws())
        names += fmt::format("{}\"{}\"", names.empty() ? "" : law == laws().back() ? " or " : ", ", law->name());
    reader.fail(node, "law must be " + names);
}

Phase read_phase(const std::string& name, TomlReader reader) {
    Phase phase;
    phase.name = name;
    phase.line = reader.line();
    reader.get("label");
    phase.label = static_cast<std::int32_t>(*reader.optional_integer("label", 1));
    phase.law = read_law(reader);
    if (auto norton = reader.table("norton", fmt::format("norton of [phase.{}]", name)))
        phase.norton = read_norton(*norton);
    phase.law->read_phase(reader, phase);
    if (auto hardening = reader.table("hardening", fmt::format("hardening of [phase.{}]", name)))
        phase.hardening = read_hardening(*hardening);
    phase.objects = reader.optional_boolean("objects").value_or(false);
    reader.refuse_unknown();
    phase.law->check_phase(reader, phase);
    return phase;
}

LoadStep read_step(const toml::node& node, const std::string& file) {
    if (!node.is_table())
        throw InvalidInput(
            fmt::format("scene '{}' line {}: a step of [load] is written {{ strain = -0.3, rate = 1e-3 }}", file,
                        TomlReader::line_of(node)));
    TomlReader reader(*node.as_table(), "a step of [load]", scene_called(file));
    LoadStep step;
    step.line = reader.line();
    step.strain = reader.quantity(reader.get("strain"), "strain");
    if (!std::isfinite(step.strain)) reader.fail(step.line, "strain in a step of [load] must be finite");
    const toml::node& rate = reader.get("rate");
    if (const toml::array* coefficients = rate.as_array()) {
        for (const toml::node& coefficient : *coefficients) step.rate.push_back(reader.quantity(coefficient, "rate"));
        if (step.rate.empty() || !(step.rate.front() > 0) ||
            !std::all_of(step.rate.begin(), step.rate.end(), [](double value) { return std::isfinite(value); }))
            reader.fail(rate,
                        "rate in a step of [load] must be a number or the coefficients of a polynomial of time, the "
                        "first above 0, such as rate = [1e-3, 2e-6]");
    } else {
        step.rate = {*reader.optional_positive("rate", units::rate)};
    }
    reader.refuse_unknown();
    return step;
}

Initiation read_initiation(TomlReader reader) {
    Initiation initiation;
    reader.get("strain");
    initiation.strain = *reader.optional_positive("strain");
    initiation.affine = reader.optional_boolean("affine").value_or(initiation.affine);
    if (const toml::node* noise = reader.find("noise")) {
        initiation.noise = reader.quantity(*noise, "noise");
        if (!(initiation.noise >= 0 && initiation.noise <= 10))
            reader.fail(*noise, fmt::format("noise in initiation is {:g}: expected 0 to 10", initiation.noise));
    }
    reader.refuse_unknown();
    return initiation;
}

std::vector<LoadStep> read_steps(const toml::node& steps, TomlReader& reader, const std::string& file) {
    if (!steps.is_array() || steps.as_array()->empty())
        reader.fail(steps, "steps in [load] must be a list such as [ { strain = -0.3, rate = 1e-3 } ]");
    std::vector<LoadStep> result;
    double reached = 0;
    for (const toml::node& node : *steps.as_array()) {
        const LoadStep step = read_step(node, file);
        const double change = step.strain - reached;
        if (change == 0) reader.fail(step.line, fmt::format("the strain is {:g} already", reached));
        if (!polynomial::time_to_reach(step.rate, std::abs(change))) {
            const double end = *polynomial::end_of_positive(step.rate);
            reader.fail(
                step.line,
                fmt::format("the rate falls to zero after {:g} s, at strain {:.4g}: before the "
                            "target strain {:g}",
                            end, reached + std::copysign(polynomial::integral(step.rate, end), change), step.strain));
        }
        reached = step.strain;
        result.push_back(step);
    }
    return result;
}

void read_load(TomlReader reader, const std::string& file, Scene& scene) {
    scene.load_line = reader.line();
    const std::string axis = reader.optional_text("axis").value_or("z");
    if (axis != "x" && axis != "y" && axis != "z")
        reader.fail(*reader.find("axis"), "axis must be \"x\", \"y\" or \"z\"");
    scene.axis = axis[0] - 'x';
    if (const toml::node* duration = reader.find("duration")) {
        if (const toml::node* steps = reader.find("steps"))
            reader.fail(*steps, "[load] has both steps and duration: planes go by steps, walls alone by a duration");
        if (scene.walls.empty())
            reader.fail(*duration, "duration in [load] is for scenes with walls; add a [[wall]], or steps");
        scene.duration = reader.optional_positive("duration", units::time);
        reader.get("rate");
        scene.nominal_rate = reader.optional_positive("rate", units::rate);
    } else {
        scene.steps = read_steps(reader.get("steps"), reader, file);
        if (const toml::node* rate = reader.find("rate"))
            reader.fail(*rate, "rate in [load] goes with duration; a step has its own: { strain = -0.3, rate = 1e-3 }");
    }
    if (auto initiation = reader.table("initiation", "initiation of [load]")) {
        scene.initiation = read_initiation(*initiation);
        if (scene.duration) reader.fail(initiation->line(), "initiation needs steps: without planes there is no flow");
        double reached = 0;
        for (const LoadStep& step : scene.steps) {
            if (scene.initiation->strain > 0.5 * std::abs(step.strain - reached))
                reader.fail(
                    initiation->line(),
                    fmt::format("initiation over a strain of {:g} is longer than half the step from {:g} to {:g}",
                                scene.initiation->strain, reached, step.strain));
            reached = step.strain;
        }
    }
    if (const auto lateral = reader.optional_text("lateral")) {
        if (lateral == "periodic")
            scene.lateral = Lateral::periodic;
        else if (lateral == "isochoric")
            scene.lateral = Lateral::isochoric;
        else if (lateral != "free")
            reader.fail(*reader.find("lateral"), "lateral must be \"free\", \"periodic\" or \"isochoric\"");
        if (scene.lateral != Lateral::free && scene.duration)
            reader.fail(*reader.find("lateral"),
                        fmt::format("lateral = \"{}\" needs steps: the sides follow the planes", *lateral));
    }
    reader.refuse_unknown();
}

Wall read_wall(const toml::node& node, const std::string& file) {
    if (!node.is_table())
        throw InvalidInput(fmt::format("scene '{}' line {}: a wall is written [[wall]] with a name and a surface", file,
                                       TomlReader::line_of(node)));
    TomlReader reader(*node.as_table(), "[[wall]]", scene_called(file));
    Wall wall;
    wall.line = reader.line();
    const toml::node& name = reader.get("name");
    wall.name = reader.optional_text("name").value();
    if (wall.name.empty() ||
        wall.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") !=
            std::string::npos)
        reader.fail(name, "name in [[wall]] must be of letters, digits, - and _: it names the curves of its force");
    reader.get("surface");
    wall.surface = std::filesystem::path(file).parent_path() / reader.optional_text("surface").value();
    if (const toml::node* unit = reader.find("unit")) {
        const std::string word = reader.optional_text("unit").value();
        try {
            wall.unit = units::length("1 " + word);
        } catch (const InvalidInput&) {
            reader.fail(*unit,
                        fmt::format("unit in [[wall]] is \"{}\": expected a length such as \"mm\" or \"um\"", word));
        }
    }
    if (const toml::node* velocity = reader.find("velocity")) {
        const toml::array* components = velocity->as_array();
        const std::string expected = "velocity in [[wall]] must be three numbers [mm/s], such as [0, 0, -0.1]";
        if (components == nullptr || components->size() != 3) reader.fail(*velocity, expected);
        for (int axis = 0; axis < 3; ++axis) {
            wall.velocity[axis] = reader.quantity((*components)[axis], "velocity");
            if (!std::isfinite(wall.velocity[axis])) reader.fail(*velocity, expected);
        }
    }
    for (const auto& [key, time] : {std::pair{"start", &wall.start}, std::pair{"stop", &wall.stop}})
        if (const toml::node* value = reader.find(key)) {
            *time = reader.quantity(*value, key, units::time);
            if (!(*time >= 0))
                reader.fail(*value, fmt::format("{} in [[wall]] is {:g} s: expected 0 or more", key, *time));
        }
    if (!(wall.stop > wall.start)) reader.fail(wall.line, "[[wall]] must stop after its start");
    reader.refuse_unknown();
    return wall;
}

std::vector<Wall> read_walls(const toml::node& node, TomlReader& reader, const std::string& file) {
    if (!node.is_array()) reader.fail(node, "walls are written [[wall]], each with a name and a surface");
    std::vector<Wall> walls;
    std::set<std::string> names;
    for (const toml::node& table : *node.as_array()) {
        walls.push_back(read_wall(table, file));
        if (!names.insert(walls.back().name).second)
            reader.fail(walls.back().line, fmt::format("two walls are called '{}'", walls.back().name));
    }
    return walls;
}

/// Longer steps than that lose their way in the geometry, and more imbalance than that is no solution.
constexpr double max_step_strain = 0.05, greatest_imbalance = 0.1;

/// What a scene leaves to its law stands in this table of a stored one: other versions may decide otherwise.
constexpr const char* resolved_table = "resolved";

std::optional<Scheme> read_scheme_word(TomlReader& reader, const LawTraits& law) {
    const auto word = reader.optional_text("scheme");
    if (!word) return {};
    if (*word == "explicit") return Scheme::explicit_steps;
    const toml::node& node = *reader.find("scheme");
    if (*word != "quasi_static")
        reader.fail(node, fmt::format("scheme is \"{}\": expected \"explicit\" or \"quasi_static\"", *word));
    if (!law.quasi_static)
        reader.fail(node, fmt::format("scheme = \"quasi_static\" needs a viscous law: law \"{}\" is solved in explicit "
                                      "steps only; remove scheme, or take law = \"norton\"",
                                      law.name));
    return Scheme::quasi_static;
}

/// @param usual  of a law that can be solved without inertia, where the scene says nothing
void read_scheme(TomlReader& reader, Scheme usual, Scene& scene) {
    const LawTraits& law = scene.law().traits();
    scene.scheme = read_scheme_word(reader, law).value_or(law.quasi_static ? usual : Scheme::explicit_steps);
    if (scene.scheme == Scheme::explicit_steps) {
        reader.refuse(
            "max_imbalance",
            "max_imbalance goes with quasi-static steps: remove it, or take law = \"norton\" without scheme = "
            "\"explicit\"");
        return;
    }
    if (scene.time_step) reader.fail(*reader.find("time_step"), of_explicit_steps("time_step"));
    if (scene.strain_per_step && *scene.strain_per_step > max_step_strain)
        reader.fail(*reader.find("strain_per_step"),
                    fmt::format("strain_per_step is {:g}: a quasi-static step takes at most {:g}",
                                *scene.strain_per_step, max_step_strain));
    if (const auto wanted = reader.optional_positive("max_imbalance")) {
        if (*wanted > greatest_imbalance)
            reader.fail(*reader.find("max_imbalance"),
                        fmt::format("max_imbalance is {:g}: the net force on the particles over the viscous one is at "
                                    "most {:g}",
                                    *wanted, greatest_imbalance));
        scene.max_imbalance = *wanted;
    }
    if (scene.initiation) reader.fail(scene.load_line, of_explicit_steps("initiation"));
}

void read_accuracy(TomlReader reader, Scheme usual, Scene& scene) {
    if (const toml::node* node = reader.find("time_step")) {
        const bool automatic = node->is_string() && *node->value<std::string>() == "auto";
        if (!automatic) scene.time_step = reader.optional_positive("time_step", units::time);
    }
    if (const auto value = reader.optional_positive("strain_per_step")) {
        if (scene.time_step)
            reader.fail(*reader.find("strain_per_step"),
                        "strain_per_step chooses the time step: remove one of the two");
        scene.strain_per_step = *value;
    }
    read_scheme(reader, usual, scene);
    scene.law().read_accuracy(reader, scene);
    if (const auto file = reader.optional_text("calibration"))
        scene.calibration_file = scene.path.parent_path() / *file;
    if (const auto window = reader.optional_positive("averaging_strain")) {
        if (scene.scheme == Scheme::quasi_static)
            reader.fail(*reader.find("averaging_strain"), of_explicit_steps("averaging_strain"));
        scene.averaging_strain = *window;
    }
    scene.frames = reader.optional_integer("frames", 1).value_or(scene.frames);
    reader.refuse_unknown();
}

std::string text_of(const std::filesystem::path& path, const std::string& what) {
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path))
        throw InvalidInput(fmt::format("cannot read {} '{}': no such file", what, path.string()));
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A table in the scene's text goes first: a stored scene keeps the name of the file and does not need it.
void read_calibration(bool in_text, Scene& scene) {
    if (in_text) {
        scene.calibration_file.clear();
        scene.calibration = parse_calibration(scene.text, scene.path.string());
    } else if (!scene.calibration_file.empty()) {
        const std::string table = text_of(scene.calibration_file, "calibration");
        scene.calibration = parse_calibration(table, scene.calibration_file.string());
        scene.text += fmt::format("\n# ---- of the calibration file ----\n{}", table);
    }
}

void read_output(TomlReader reader, Scene& scene) {
    scene.write_velocity = reader.optional_boolean("velocity").value_or(false);
    scene.write_stress = reader.optional_boolean("stress").value_or(false);
    reader.refuse_unknown();
}

void read_contact(TomlReader reader, Scene& scene) {
    scene.self_contact = reader.optional_boolean("self_contact").value_or(false);
    reader.refuse("between_objects", "between_objects is called objects_only_push now");
    scene.objects_only_push = reader.optional_boolean("objects_only_push").value_or(false);
    if (const toml::node* node = reader.find("healing_time")) {
        scene.healing_time = reader.quantity(*node, "healing_time", units::time);
        if (!(scene.healing_time > 0))
            reader.fail(*node, fmt::format("healing_time is {:g}: expected more than 0", scene.healing_time));
        if (!scene.self_contact && std::isfinite(scene.healing_time))
            reader.fail(*node, "healing_time without self_contact = true has no effect: remove it");
    }
    reader.refuse_unknown();
}

void check_loads_against_laws(const Scene& scene, const TomlReader& reader) {
    double reached = 0;
    for (const LoadStep& step : scene.steps) {
        if (step.strain > reached)
            for (const Phase& phase : scene.phases)
                if (!phase.law->traits().carries_tension)
                    reader.fail(step.line,
                                fmt::format("the step from strain {:g} to {:g} is tension, which law \"{}\" of "
                                            "[phase.{}] cannot carry; keep to decreasing strains",
                                            reached, step.strain, phase.law->name(), phase.name));
        reached = step.strain;
    }
}

}  // namespace

double Norton::stress(double rate) const {
    return consistency * std::pow(rate, rate_sensitivity);
}

double Hardening::factor(double time) const {
    if (table.empty()) return amplitude * std::exp(rate * (time + offset) + exponent) + base;
    const auto after = std::find_if(table.begin(), table.end(), [time](const auto& row) { return row[0] > time; });
    if (after == table.begin()) return table.front()[1];
    if (after == table.end()) return table.back()[1];
    const auto& [left, right] = std::pair(*(after - 1), *after);
    return std::lerp(left[1], right[1], (time - left[0]) / (right[0] - left[0]));
}

std::string of_explicit_steps(const std::string& key) {
    return fmt::format(
        "{} belongs to explicit steps, and law \"norton\" takes quasi-static ones unless it is told otherwise: add "
        "scheme = \"explicit\" to [accuracy], or remove {}",
        key, key);
}

std::optional<double> number_of(const LawNumbers& numbers, std::string_view key) {
    const auto found = numbers.find(key);
    return found == numbers.end() ? std::nullopt : std::optional(found->second);
}

const Phase& Scene::phase(std::int32_t label) const {
    for (const Phase& phase : phases)
        if (phase.label == label) return phase;
    throw InvalidInput(fmt::format(
        "scene '{}' has no phase with label {}, which the sample contains; add a [phase.NAME] with label = {}",
        path.string(), label, label));
}

double Scene::highest_rate() const {
    double highest = nominal_rate.value_or(0.0), reached = 0;
    for (const LoadStep& step : steps) {
        const double end = polynomial::time_to_reach(step.rate, std::abs(step.strain - reached)).value();
        highest = std::max(highest, polynomial::largest_magnitude(step.rate, end));
        reached = step.strain;
    }
    return highest;
}

double Scene::lowest_rate() const {
    double lowest = highest_rate();
    for (const LoadStep& step : steps) lowest = std::min(lowest, step.rate.front());
    return lowest;
}

double Scene::path_length() const {
    double length = duration ? *duration * *nominal_rate : 0, reached = 0;
    for (const LoadStep& step : steps) {
        length += std::abs(step.strain - reached);
        reached = step.strain;
    }
    return length;
}

namespace {

/// Keys of earlier versions get their names of today.
void rename_old_keys(toml::table& root) {
    const auto rename = [&](const char* table, const char* old_key, const std::string& key) {
        toml::table* const found = root[table].as_table();
        if (found == nullptr || !found->contains(old_key)) return;
        found->insert(key, *found->get(old_key));
        found->erase(old_key);
    };
    rename("contact", "between_objects", "objects_only_push");
    const toml::table* const phases = root["phase"].as_table();
    const auto law_of = [](const toml::node& phase) {
        return phase.is_table() ? (*phase.as_table())["law"].value_or(std::string()) : std::string();
    };
    const bool viscous = phases != nullptr && !phases->empty() && law_of(phases->begin()->second) == "norton";
    rename("accuracy", "equilibrium_error", viscous ? "inertia_share" : "max_equilibrium_error");
}

/// @param usual  scheme of a law that can be solved without inertia, where the scene says nothing
Scene scene_of(const toml::table& root, const std::string& text, const std::string& name, Scheme usual) {
    Scene scene;
    scene.path = name;
    scene.text = text;
    TomlReader reader(root, "the scene", scene_called(name));
    scene.unusual_values = reader.optional_boolean("unusual_values").value_or(false);
    scene.seed_radius = reader.optional_positive("seed_radius", units::length).value_or(scene.seed_radius);
    const auto crown = reader.optional_positive("crown_radius", units::length);
    if (crown && *crown <= scene.seed_radius)
        reader.fail(*reader.find("crown_radius"), "crown_radius must be larger than seed_radius");
    if (const toml::node* node = reader.find("radius_dispersion")) {
        scene.radius_dispersion = reader.quantity(*node, "radius_dispersion");
        if (!(scene.radius_dispersion >= 0 && scene.radius_dispersion <= max_dispersion))
            reader.fail(*node, fmt::format("radius_dispersion is {:g}: expected 0 to {:g}", scene.radius_dispersion,
                                           max_dispersion));
    }

    const toml::node& phases = reader.get("phase");
    if (!phases.is_table() || phases.as_table()->empty())
        reader.fail(phases, "phases are written [phase.NAME] with a label and a law");
    std::set<std::int32_t> labels;
    for (const auto& [key, node] : *phases.as_table()) {
        const std::string phase_name(key.str());
        if (!node.is_table()) reader.fail(node, fmt::format("phase.{} must be a table", phase_name));
        const Phase phase =
            read_phase(phase_name, TomlReader(*node.as_table(), "[phase." + phase_name + "]", reader.file()));
        if (!labels.insert(phase.label).second)
            reader.fail(phase.line, fmt::format("label {} of [phase.{}] belongs to another phase already", phase.label,
                                                phase_name));
        if (!scene.phases.empty() && phase.law != &scene.law())
            reader.fail(phase.line,
                        fmt::format("[phase.{}] has another law than [phase.{}]: all phases of a sample have one law",
                                    phase.name, scene.phases.front().name));
        scene.phases.push_back(phase);
    }
    const LawTraits& law = scene.law().traits();
    scene.crown_radius = crown.value_or(law.crown_over_seed * scene.seed_radius);
    scene.law().check_scene(reader, scene);

    if (auto contact = reader.table("contact", "[contact]")) read_contact(*contact, scene);
    if (const toml::node* walls = reader.find("wall")) scene.walls = read_walls(*walls, reader, name);
    reader.get("load");
    read_load(*reader.table("load", "[load]"), name, scene);
    const bool resolved = reader.find(resolved_table) != nullptr;
    if (auto table = reader.table(resolved_table, "[resolved]")) {
        usual = read_scheme_word(*table, law).value_or(usual);
        table->refuse_unknown();
    }
    const toml::table empty;
    auto accuracy = reader.table("accuracy", "[accuracy]");
    const bool says_scheme = accuracy && accuracy->find("scheme") != nullptr;
    read_accuracy(accuracy.value_or(TomlReader(empty, "[accuracy]", reader.file())), usual, scene);
    if (!says_scheme && !resolved && scene.scheme == Scheme::quasi_static)
        scene.text += fmt::format("\n# ---- what the scene leaves to its law ----\n[{}]\nscheme = \"quasi_static\"\n",
                                  resolved_table);
    read_calibration(reader.find("calibration") != nullptr, scene);
    if (auto output = reader.table("output", "[output]")) read_output(*output, scene);
    reader.refuse_unknown();
    check_loads_against_laws(scene, reader);
    return scene;
}

/// Not in a stored scene: runs of earlier versions that had it can still be measured.
void refuse_self_contact(const toml::table& root, const Scene& scene, const std::string& name) {
    if (!scene.self_contact || scene.law().traits().self_contact) return;
    TomlReader reader(root, "the scene", scene_called(name));
    auto contact = reader.table("contact", "[contact]");
    contact->fail(
        *contact->find("self_contact"),
        fmt::format("law \"{}\" cannot tell surfaces that meet from the pairs inside: remove self_contact, or "
                    "take law \"trilin\"",
                    scene.law().name()));
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& name) {
    const toml::table root = parse_toml(text, scene_called(name));
    Scene scene = scene_of(root, text, name, Scheme::quasi_static);
    refuse_self_contact(root, scene, name);
    if (!scene.unusual_values) refuse_unusual_values(scene);
    return scene;
}

Scene parse_stored_scene(const std::string& text, const std::string& name) {
    toml::table root = parse_toml(text, scene_called(name));
    rename_old_keys(root);
    return scene_of(root, text, name, Scheme::explicit_steps);
}

Scene read_scene(const std::filesystem::path& path) {
    return parse_scene(text_of(path, "scene"), path.string());
}

}  // namespace tomodem
