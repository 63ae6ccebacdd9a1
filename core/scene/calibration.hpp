#pragma once
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Measured flow stresses: what turns norton = { K, M } into the constants of a law, and how far it may be trusted
/// (docs/calibration.md has the file).
namespace tomodem {

class TomlReader;

/// What the flow stresses of a law were measured on, and what they are worth. Errors are shares of the stress.
/// The table of each law adds its flow stresses: core/scene/laws/.
struct CalibrationWindow {
    virtual ~CalibrationWindow() = default;

    int packings = 0;
    double density = 0;                  ///< D of the packings
    std::vector<double> particles;       ///< sizes seen, increasing
    std::vector<double> size;            ///< stress of each size over the table's, less 1: the largest seen
    std::array<double, 2> strain{0, 0};  ///< |true strain| within which the stress keeps to the table's ...
    std::optional<std::array<double, 2>> strain_tension;  ///< the same in tension; none: not measured
    double strain_error = 0;                              ///< ... within this
    std::optional<double> crown;                          ///< r_c / r_s (not NORTON's: it has one only)
    std::optional<double> stiffness_ratio;                ///< k_rep / k_att (the same)

    /// `size` for a sample of so many particles: straight in their logarithm, constant beyond the sizes seen.
    double size_error(double count) const;
};

/// Errors of TRILIN and NORTON: the largest deviation from the law fitted, and twice the spread over packings.
struct DirectedErrors {
    std::optional<double> compression, tension;  ///< none: not measured
};

struct Calibration {
    std::string name;
    std::map<std::string, std::shared_ptr<const CalibrationWindow>, std::less<>> tables;  ///< by the law's name

    /// The table of one law, such as find<BilinCalibration>(); null if the calibration does not hold it.
    template <class Table>
    const Table* find() const {
        const auto found = tables.find(Table::law);
        return found == tables.end() ? nullptr : static_cast<const Table*>(found->second.get());
    }
    template <class Table>
    void add(Table table) {
        tables[Table::law] = std::make_shared<const Table>(std::move(table));
    }
};

/// The keys that the table of every law has. @param has_crown  crown and stiffness_ratio too
void read_window(TomlReader& reader, CalibrationWindow& window, bool has_crown);

/// The keys `compression` and `tension`.
DirectedErrors read_errors(TomlReader& reader);

/// Reads the table [calibration] of a TOML text, a scene's or one of its own; `file` stands for it in errors.
/// @throws InvalidInput with the line: syntax, unknown or missing key, lists that do not fit together, wrong range
Calibration parse_calibration(const std::string& text, const std::string& file);

/// The one that tomodem ships (core/law/calibration.toml).
const Calibration& shipped_calibration();

}  // namespace tomodem
