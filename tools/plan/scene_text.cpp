#include "tools/plan/scene_text.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.hpp"
#include "tools/plan/trade_table.hpp"

namespace tomodem::plan {
namespace {

constexpr const char* step_key = "strain_per_step";

struct Edit {
    std::size_t first, last;  ///< bytes replaced
    std::string by;
};

/// Byte of a place in the text; columns count characters of UTF-8.
std::size_t byte_of(const std::string& text, const toml::source_position& place) {
    std::size_t at = 0;
    for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
    for (toml::source_index column = 1; column < place.column && at < text.size(); ++column) do
            ++at;
        while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80);
    return at;
}

std::size_t end_of_line(const std::string& text, std::size_t at) {
    const std::size_t end = text.find('\n', at);
    return end == std::string::npos ? text.size() : end;
}

Edit replacement(const std::string& text, const toml::source_region& place, std::string by) {
    return {byte_of(text, place.begin), byte_of(text, place.end), std::move(by)};
}

void choose_law(const std::string& text, const toml::table& root, const std::string& law, std::vector<Edit>& edits) {
    for (const auto& [name, node] : *root.get_as<toml::table>("phase")) {
        const toml::node* key = node.as_table()->get("law");
        const std::string wanted = fmt::format("\"{}\"", law);
        if (key != nullptr && key->value_or(std::string{}) != law)
            edits.push_back(replacement(text, key->source(), wanted));
        if (key == nullptr && law != "bilin") {
            const std::size_t at = end_of_line(text, byte_of(text, node.as_table()->get("label")->source().begin));
            edits.push_back({at, at, "\nlaw = " + wanted});
        }
    }
}

void choose_step(const std::string& text, const toml::table& root, const SceneChoice& choice,
                 std::vector<Edit>& edits) {
    const std::string line = fmt::format("{} = {:.4g}", step_key, choice.step);
    const toml::table* accuracy = root.get_as<toml::table>("accuracy");
    if (accuracy == nullptr) {
        edits.push_back({text.size(), text.size(),
                         fmt::format("{}\n[accuracy]\n{}\n", text.empty() || text.back() == '\n' ? "" : "\n", line)});
        return;
    }
    // Of its own line; in an inline table it stays, and the law refuses it.
    if (const toml::node* window = accuracy->get("averaging_strain");
        window != nullptr && find_law(choice.law)->traits().quasi_static && !accuracy->is_inline()) {
        const std::size_t at = byte_of(text, window->source().begin), begin = text.rfind('\n', at) + 1;
        edits.push_back({begin, std::min(end_of_line(text, at) + 1, text.size()), ""});
    }
    // A scene has one of them at most.
    for (const auto& [key, node] : *accuracy) {
        const bool automatic = key == "time_step" && node.is_string() && node.value_or(std::string{}) == "auto";
        if (automatic || (key != "time_step" && key != "strain_per_step" && key != "inertia_share" &&
                          key != "max_equilibrium_error"))
            continue;
        if (key != step_key || node.value_or(0.0) != std::stod(fmt::format("{:.4g}", choice.step)))
            edits.push_back({byte_of(text, key.source().begin), byte_of(text, node.source().end), line});
        return;
    }
    const std::size_t begin = byte_of(text, accuracy->source().begin);
    if (accuracy->is_inline()) {
        edits.push_back({begin + 1, begin + 1, fmt::format(" {}{}", line, accuracy->empty() ? " " : ",")});
    } else {
        const std::size_t at = end_of_line(text, begin);
        edits.push_back({at, at, "\n" + line});
    }
}

/// Of a text that is TOML at all, with phases in it.
toml::table parsed(const std::string& text, const std::string& name) {
    try {
        toml::table root = toml::parse(text);
        if (const auto* phases = root.get_as<toml::table>("phase");
            phases != nullptr && std::all_of(phases->begin(), phases->end(), [](const auto& phase) {
                return phase.second.is_table() && phase.second.as_table()->contains("label");
            }))
            return root;
    } catch (const toml::parse_error&) {
        // parse_scene says what and where.
    }
    parse_scene(text, name);
    throw InvalidInput(fmt::format("scene '{}' has no phases that a law could be put into", name));
}

}  // namespace

std::string with_choice(const std::string& text, const SceneChoice& choice, const std::string& name) {
    const toml::table root = parsed(text, name);
    std::vector<Edit> edits;
    choose_law(text, root, choice.law, edits);
    choose_step(text, root, choice, edits);
    std::sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.first > b.first; });
    std::string changed = text;
    for (const Edit& edit : edits) changed.replace(edit.first, edit.last - edit.first, edit.by);

    const Scene scene = parse_scene(changed, name);
    if (scene.law().name() != choice.law || std::abs(scene.step_strain() / choice.step - 1) > 1e-3 || scene.time_step)
        throw InvalidInput(fmt::format(
            "scene '{}': cannot put law = \"{}\" and {} = {:.4g} into it; write each key on a line of its own below "
            "[accuracy]",
            name, choice.law, step_key, choice.step));
    return changed;
}

Scene readable_scene(const std::string& text, const std::string& name) {
    try {
        return parse_scene(text, name);
    } catch (const InvalidInput&) {
        for (const SceneChoice& other : {SceneChoice{"norton", 8e-3}, {"trilin", 1e-4}, {"bilin", 2e-5}}) try {
                return parse_scene(with_choice(text, other, name), name);
            } catch (const InvalidInput&) {
                // The next law, or what is wrong with the first.
            }
        throw;
    }
}

}  // namespace tomodem::plan
