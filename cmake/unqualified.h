#pragma once

namespace foucault {
namespace geodesy {}
using namespace geodesy;
namespace state {}
using namespace state;
namespace measurement {}
using namespace measurement;
namespace imu {}
using namespace imu;
namespace preintegration {}
using namespace preintegration;
namespace ekf {}
using namespace ekf;
namespace fgo {}
using namespace fgo;
namespace alignment {}
using namespace alignment;
namespace diagnosis {}
using namespace diagnosis;
namespace navigation {}
using namespace navigation;
namespace simulation {}
using namespace simulation;
namespace laboratory {}
using namespace laboratory;
namespace evaluation {}
using namespace evaluation;
namespace rawlog {}
using namespace rawlog;
}  // namespace foucault
