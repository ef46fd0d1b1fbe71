#include "mujoco_arm.h"

#include <array>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "bench/published_arm.h"

namespace rigwire::sim {
namespace {

class Xml {
 public:
  Xml() { text_.precision(17); }

  /// A body whose x is raised by `angle_rad` against its parent, at (x, z).
  void open(const char* name, double x, double y, double z, double angle_rad) {
    text_ << "<body name='" << name << "' pos='" << x << ' ' << y << ' ' << z << "' euler='0 "
          << -angle_rad << " 0'>";
  }
  void close() { text_ << "</body>"; }
  void hinge(const char* name, const char* axis = "0 -1 0") {
    text_ << "<joint name='" << name << "' type='hinge' axis='" << axis << "'/>";
  }
  void slide(const char* name) {
    text_ << "<joint name='" << name << "' type='slide' axis='1 0 0'/>";
  }
  void inertial(const RigidBodyParameters& p) {
    const Eigen::Vector3d& c = p.center_of_mass_m;
    const Eigen::Vector3d& i = p.principal_inertia_kgm2;
    text_ << "<inertial pos='" << c.x() << ' ' << c.y() << ' ' << c.z() << "' mass='" << p.mass_kg
          << "' diaginertia='" << i.x() << ' ' << i.y() << ' ' << i.z() << "'/>";
  }
  void small(double center_x) { inertial({kSmallMass_kg, {center_x, 0.0, 0.0}, {0.5, 1.5, 1.5}}); }
  /// Tube hinged at (x, z) with its rod's end `length` away in the direction `angle`.
  void cylinder(const char* tube, const char* rod, double x, double z, double angle,
                double length) {
    open(tube, x, 0.0, z, angle);
    hinge(tube);
    small(0.4);
    open(rod, length, 0.0, 0.0, 0.0);
    slide(rod);
    small(-0.4);
    close();
    close();
  }
  // Connects two bodies as stiffly as MuJoCo advises for the step, and nearly hard.
  void connect(const char* body1, const char* body2, double x, double step_s) {
    text_ << "<connect body1='" << body1 << "' body2='" << body2 << "' anchor='" << x
          << " 0 0' solref='" << 2.0 * step_s << " 1' solimp='0.99 0.999 0.001'/>";
  }
  void drive(const char* joint, double k, double d) {
    text_ << "<general joint='" << joint << "' gainprm='" << k << "' biastype='affine' biasprm='0 "
          << -k << ' ' << -d << "'/>";
  }
  template <typename T>
  Xml& operator<<(const T& value) {
    text_ << value;
    return *this;
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

double direction(const Eigen::Vector2d& v) {
  return std::atan2(v.y(), v.x());
}

Eigen::Vector2d turned(const Eigen::Vector2d& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
          std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

std::string describe(const ExcavatorParameters& p, const DriveGains& gains, bool looped,
                     double step_s, const std::string& integrator) {
  const JointVector& q = bench::kPublishedPose;
  Xml xml;
  xml << "<mujoco><compiler angle='radian' inertiafromgeom='false'/><option timestep='" << step_s
      << "' gravity='0 0 " << -p.gravity_mps2 << "' integrator='" << integrator << "'/><worldbody>";
  xml.open("upper", 0.0, 0.0, p.swing_axis_height_m, 0.0);
  xml.hinge("swing", "0 0 1");
  xml.inertial(p.upper);
  const Eigen::Vector3d& foot = p.boom_foot_m;
  if (looped) {
    const Eigen::Vector2d base = p.boom_linkage.base_pin_m;
    const Eigen::Vector2d way = turned(p.boom_linkage.rod_pin_m, q[1]) - base;
    xml.cylinder("boom_tube", "boom_rod", foot.x() + base.x(), foot.z() + base.y(), direction(way),
                 way.norm());
  }
  xml.open("boom", foot.x(), foot.y(), foot.z(), q[1]);
  xml.hinge("boom");
  xml.inertial(p.boom);
  if (looped) {
    const Eigen::Vector2d base = p.stick_linkage.base_pin_m;
    const Eigen::Vector2d way =
        Eigen::Vector2d(p.boom_length_m, 0.0) + turned(p.stick_linkage.rod_pin_m, q[2]) - base;
    xml.cylinder("stick_tube", "stick_rod", base.x(), base.y(), direction(way), way.norm());
  }
  xml.open("stick", p.boom_length_m, 0.0, 0.0, q[2]);
  xml.hinge("stick");
  xml.inertial(p.stick);
  if (looped) {
    const BucketLinkage four_bar(p.bucket_linkage, p.stick_length_m);
    const Eigen::Vector2d joint = four_bar.idler_joint_m(q[3]);
    const Eigen::Vector2d base = p.bucket_linkage.base_pin_m;
    const Eigen::Vector2d pivot = p.bucket_linkage.idler_pivot_m;
    const double lug_direction = q[3] + p.bucket_linkage.lug_angle_rad;
    const Eigen::Vector2d lug = Eigen::Vector2d(p.stick_length_m, 0.0) +
                                turned({p.bucket_linkage.lug_radius_m, 0.0}, lug_direction);
    xml.cylinder("bucket_tube", "bucket_rod", base.x(), base.y(), direction(joint - base),
                 (joint - base).norm());
    const double idler = direction(joint - pivot);
    xml.open("idler", pivot.x(), 0.0, pivot.y(), idler);
    xml.hinge("idler");
    xml.small(0.26);
    xml.open("link", p.bucket_linkage.idler_length_m, 0.0, 0.0, direction(lug - joint) - idler);
    xml.hinge("link");
    xml.small(0.25);
    xml.close();
    xml.close();
  }
  xml.open("bucket", p.stick_length_m, 0.0, 0.0, q[3]);
  xml.hinge("bucket");
  xml.inertial(p.bucket);
  xml << "</body></body></body></body></worldbody>";
  if (looped) {
    xml << "<equality>";
    xml.connect("boom_rod", "boom", 0.0, step_s);
    xml.connect("stick_rod", "stick", 0.0, step_s);
    xml.connect("bucket_rod", "idler", 0.0, step_s);
    xml.connect("link", "bucket", p.bucket_linkage.link_length_m, step_s);
    xml << "</equality><actuator>";
    xml.drive("swing", gains.stiffness[0], gains.damping[0]);
    xml.drive("boom_rod", gains.stiffness[1], gains.damping[1]);
    xml.drive("stick_rod", gains.stiffness[2], gains.damping[2]);
    xml.drive("bucket_rod", gains.stiffness[3], gains.damping[3]);
    xml << "</actuator>";
  }
  xml << "</mujoco>";
  return xml.text();
}

mjModel* load(const std::string& xml) {
  auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "arm.xml")], xml.data(), xml.size());
  std::array<char, 500> error{};
  mjModel* model = mj_loadXML("arm.xml", files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  }
  return model;
}

constexpr std::array<const char*, kArmJoints> kHinges{"swing", "boom", "stick", "bucket"};

}  // namespace

MujocoArm::MujocoArm(const ExcavatorParameters& parameters, const DriveGains& gains,
                     MujocoArmKind kind, double step_s, const std::string& integrator)
    : model_(load(describe(parameters, gains, kind == MujocoArmKind::looped, step_s, integrator))),
      data_(mj_makeData(model_.get())),
      gains_(gains),
      start_x_(DrivenArm(parameters, Eigen::Vector3d(0.0, 0.0, -parameters.gravity_mps2))
                   .pose(bench::kPublishedPose)
                   .x) {
  mj_forward(model_.get(), data_.get());
}

JointMatrix MujocoArm::mass_matrix() {
  mj_forward(model_.get(), data_.get());
  std::array<double, 16> full{};
  mj_fullM(model_.get(), full.data(), data_->qM);
  return JointMatrix(full.data());
}

JointVector MujocoArm::bias() {
  mj_forward(model_.get(), data_.get());
  return JointVector(data_->qfrc_bias);
}

JointVector MujocoArm::joint_angles_rad() const {
  JointVector q = bench::kPublishedPose;
  for (int i = 0; i < kArmJoints; ++i) {
    const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, kHinges[static_cast<std::size_t>(i)]);
    q[i] += data_->qpos[model_->jnt_qposadr[joint]];
  }
  return q;
}

void MujocoArm::command(const JointVector& target, const JointVector& rate) {
  for (int i = 0; i < kArmJoints; ++i) {
    data_->ctrl[i] = target[i] - start_x_[i] + gains_.damping[i] / gains_.stiffness[i] * rate[i];
  }
}

double MujocoArm::loop_gap_m() const {
  double gap = 0.0;
  for (int i = 0; i < model_->neq; ++i) {
    std::array<Eigen::Vector3d, 2> end;
    for (int half = 0; half < 2; ++half) {
      const int body = half == 0 ? model_->eq_obj1id[i] : model_->eq_obj2id[i];
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data_->xmat +
                                                                             9 * body);
      const Eigen::Map<const Eigen::Vector3d> origin(data_->xpos + 3 * body);
      const Eigen::Map<const Eigen::Vector3d> anchor(model_->eq_data + mjNEQDATA * i + 3 * half);
      end[static_cast<std::size_t>(half)] = origin + R * anchor;
    }
    gap = std::max(gap, (end[0] - end[1]).norm());
  }
  return gap;
}

int MujocoArm::warnings() const {
  return data_->warning[mjWARN_BADQPOS].number + data_->warning[mjWARN_BADQVEL].number +
         data_->warning[mjWARN_BADQACC].number;
}

}  // namespace rigwire::sim
