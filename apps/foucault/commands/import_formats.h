#pragma once

#include <functional>
#include <string>

#include "command.h"
#include "foucault/rawlog/import.h"

/// The formats of `foucault import`, and what their commands have in common.
namespace foucault::app {

/// Each declares the options of its format, as the `Declare` of a Command does.
std::function<void(Call&)> declare_import_i2nav(CLI::App& app);
std::function<void(Call&)> declare_import_rtklib(CLI::App& app);
std::function<void(Call&)> declare_import_csv(CLI::App& app);
std::function<void(Call&)> declare_import_nmea(CLI::App& app);
std::function<void(Call&)> declare_import_ulog(CLI::App& app);
std::function<void(Call&)> declare_import_bag(CLI::App& app);
std::function<void(Call&)> declare_import_ubx(CLI::App& app);
std::function<void(Call&)> declare_import_rinex(CLI::App& app);
std::function<void(Call&)> declare_import_novatel(CLI::App& app);
std::function<void(Call&)> declare_import_dataflash(CLI::App& app);
std::function<void(Call&)> declare_import_auto(CLI::App& app);

/// The format of that name; null if this program has none.
const Command* find_import(const std::string& name);

inline constexpr const char* kLeverArmHelp =
    "IMU to antenna along the vehicle's forward, right, down [m]: X,Y,Z";

/// --out and --skip-bad-rows.
void add_import_options(CLI::App& app, rawlog::ImportOptions& options);

/// Says what came in.
void report_import(Console& console, const rawlog::ImportSummary& summary, const std::string& out);

}  // namespace foucault::app
