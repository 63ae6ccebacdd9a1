#pragma once
#include <string>
#include <string_view>

namespace tomodem::units {

/// Reads a number with its unit into tomodem's unit set (mm, g, s; hence uN for forces and Pa for stresses).
///
/// Known units: length nm um µm mm cm m; time ms s min h; rate 1/s s^-1; stiffness uN/mm N/mm N/m;
/// force uN mN N; stress Pa kPa MPa GPa; mass mg g kg.
///
/// @param text  such as "2.4um" or "2.4 um"
/// @throws InvalidInput if the number or its unit is missing, or the unit measures something else
double length(std::string_view text);
double time(std::string_view text);
double rate(std::string_view text);
double stiffness(std::string_view text);
double force(std::string_view text);
double stress(std::string_view text);
double mass(std::string_view text);

}  // namespace tomodem::units
