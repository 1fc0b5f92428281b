// Compares the decoupled solver with a literal, slow implementation of its definition in double.
#include <complex>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

using Plane = std::vector<std::vector<double>>;  ///< [row][col]

constexpr double kPi = std::numbers::pi;
constexpr int kSize = 128;

std::vector<Plane> standardised(const std::vector<float>& features, int channels) {
  std::vector<Plane> planes(channels,
                            Plane(kFeatureGrid.rows, std::vector<double>(kFeatureGrid.cols)));
  for (int c = 0; c < channels; ++c) {
    double sum = 0.0;
    double square = 0.0;
    for (int i = 0; i < kFeatureGrid.cells(); ++i) {
      const double value = features[c * kFeatureGrid.cells() + i];
      planes[c][i / kFeatureGrid.cols][i % kFeatureGrid.cols] = value;
      sum += value;
      square += value * value;
    }
    const double mean = sum / kFeatureGrid.cells();
    const double std = std::sqrt(square / kFeatureGrid.cells() - mean * mean);
    for (auto& row : planes[c]) {
      for (double& value : row) value = (value - mean) / (std + 0.01);
    }
  }
  return planes;
}

/// Amplitudes of the Fourier transform of the windowed plane: within each row, then across rows.
Plane amplitude(const Plane& plane) {
  const auto root = [](int k) { return std::polar(1.0, -2.0 * kPi * (k % kSize) / kSize); };
  std::vector<std::vector<std::complex<double>>> half(kFeatureGrid.rows,
                                                      std::vector<std::complex<double>>(kSize));
  for (int r = 0; r < kFeatureGrid.rows; ++r) {
    for (int k = 0; k < kSize; ++k) {
      for (int c = 0; c < kFeatureGrid.cols; ++c) {
        const double window = (0.5 - 0.5 * std::cos(2.0 * kPi * r / (kFeatureGrid.rows - 1))) *
                              (0.5 - 0.5 * std::cos(2.0 * kPi * c / (kFeatureGrid.cols - 1)));
        half[r][k] += window * plane[r][c] * root(k * c);
      }
    }
  }
  Plane result(kSize, std::vector<double>(kSize));
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      std::complex<double> sum = 0.0;
      for (int r = 0; r < kFeatureGrid.rows; ++r) sum += half[r][k] * root(j * r);
      result[j][k] = std::abs(sum);
    }
  }
  return result;
}

double read_wrapped(const Plane& plane, double row, double col) {
  const int r = static_cast<int>(std::floor(row));
  const int c = static_cast<int>(std::floor(col));
  const double fr = row - r;
  const double fc = col - c;
  const auto at = [&](int i, int j) { return plane[(i + kSize) % kSize][(j + kSize) % kSize]; };
  return (1 - fr) * (1 - fc) * at(r, c) + (1 - fr) * fc * at(r, c + 1) +
         fr * (1 - fc) * at(r + 1, c) + fr * fc * at(r + 1, c + 1);
}

/// Yaw features [band][angle] of one channel.
Plane signature(const Plane& plane) {
  const Plane spectrum = amplitude(plane);
  Plane result(8, std::vector<double>(360));
  for (int band = 0; band < 8; ++band) {
    for (int i = 0; i < 360; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double frequency = 0.05 + (4 * band + j + 0.5) * (0.8 - 0.05) / 32.0;
        const double theta = radians(0.5 * i);
        const double bin = frequency * kFeatureGrid.cell_m * kSize;
        result[band][i] +=
            0.25 * read_wrapped(spectrum, bin * std::cos(theta), bin * std::sin(theta));
      }
    }
    double mean = 0.0;
    double variance = 0.0;
    for (double value : result[band]) mean += value / 360.0;
    for (double value : result[band]) variance += (value - mean) * (value - mean) / 360.0;
    for (double& value : result[band]) value = (value - mean) / (std::sqrt(variance) + 1e-3);
  }
  return result;
}

double yaw_score(const std::vector<Plane>& bev, const std::vector<Plane>& map, double yaw_rad) {
  double sum = 0.0;
  for (size_t c = 0; c < bev.size(); ++c) {
    for (int band = 0; band < 8; ++band) {
      for (int i = 0; i < 360; ++i) {
        const double angle = i - degrees(yaw_rad) / 0.5;
        const int whole = static_cast<int>(std::floor(angle));
        const double fraction = angle - whole;
        const double turned = (1 - fraction) * bev[c][band][(whole + 360) % 360] +
                              fraction * bev[c][band][(whole + 361) % 360];
        sum += std::pow(map[c][band][i] - turned, 2);
      }
    }
  }
  return -sum / static_cast<double>(bev.size() * 8 * 360);
}

/// features(R(-yaw) (p - t)) at p = (x_m, y_m), bilinear, zero outside.
double moved(const Plane& plane, double x_m, double y_m, const Se2& motion) {
  const Eigen::Vector2d source = motion.inverse() * Eigen::Vector2d(x_m, y_m);
  const double row = kFeatureGrid.row_of_x(source.x());
  const double col = kFeatureGrid.col_of_y(source.y());
  double sum = 0.0;
  for (int i = static_cast<int>(std::floor(row)); i <= std::floor(row) + 1; ++i) {
    for (int j = static_cast<int>(std::floor(col)); j <= std::floor(col) + 1; ++j) {
      if (i < 0 || j < 0 || i >= kFeatureGrid.rows || j >= kFeatureGrid.cols) continue;
      sum += (1 - std::abs(row - i)) * (1 - std::abs(col - j)) * plane[i][j];
    }
  }
  return sum;
}

/// Axis features along x or y of one channel rotated by yaw.
std::vector<double> axis_features(const Plane& plane, double yaw_rad, bool along_x) {
  const int length = along_x ? kFeatureGrid.rows : kFeatureGrid.cols;
  const int across = along_x ? kFeatureGrid.cols : kFeatureGrid.rows;
  std::vector<double> result(length);
  for (int i = 0; i < length; ++i) {
    for (int j = 4; j < across - 4; ++j) {
      const double x = kFeatureGrid.x_of_row(along_x ? i : j);
      const double y = kFeatureGrid.y_of_col(along_x ? j : i);
      result[i] += moved(plane, x, y, {0.0, 0.0, yaw_rad}) / (across - 8);
    }
  }
  return result;
}

double axis_score(const std::vector<std::vector<double>>& bev,
                  const std::vector<std::vector<double>>& map, double shift_m) {
  double sum = 0.0;
  for (size_t c = 0; c < bev.size(); ++c) {
    const int count = static_cast<int>(map[c].size()) - 8;
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 4; i < count + 4; ++i) {
      const double position = i + shift_m / kFeatureGrid.cell_m;
      const int whole = static_cast<int>(std::floor(position));
      const double fraction = position - whole;
      a.push_back(map[c][i]);
      b.push_back((1 - fraction) * bev[c][whole] +
                  (fraction > 0.0 ? fraction * bev[c][whole + 1] : 0.0));
    }
    double mean_a = 0.0;
    double mean_b = 0.0;
    for (int i = 0; i < count; ++i) {
      mean_a += a[i] / count;
      mean_b += b[i] / count;
    }
    double var_a = 0.0;
    double var_b = 0.0;
    double cov = 0.0;
    for (int i = 0; i < count; ++i) {
      var_a += (a[i] - mean_a) * (a[i] - mean_a) / count;
      var_b += (b[i] - mean_b) * (b[i] - mean_b) / count;
      cov += (a[i] - mean_a) * (b[i] - mean_b) / count;
    }
    sum += cov / std::sqrt((var_a + 1e-3) * (var_b + 1e-3));
  }
  return sum / static_cast<double>(bev.size());
}

std::vector<double> distribution(const HypothesisAxis& axis, double scale,
                                 const std::function<double(double)>& score) {
  std::vector<double> result;
  double sum = 0.0;
  for (int i = 0; i < axis.count(); ++i) {
    result.push_back(std::exp(scale * score(axis.value(i))));
    sum += result.back();
  }
  for (double& probability : result) probability /= sum;
  return result;
}

double mean(const std::vector<double>& probability, const HypothesisAxis& axis) {
  double result = 0.0;
  for (int i = 0; i < axis.count(); ++i) result += probability[i] * axis.value(i);
  return result;
}

void expect_near(const std::vector<float>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-4) << i;
}

TEST(DecoupledReferenceTest, AgreesWithItsDefinition) {
  constexpr int kChannels = 3;  // less than one vector
  const HypothesisGrid hypotheses;
  const SolverParameters parameters{
      .joint_scale = 90.0F, .x_scale = 70.0F, .y_scale = 80.0F, .yaw_scale = 30.0F};
  const SyntheticScene scene = SyntheticScene::structured(kChannels, 11);
  auto bev = scene.seen_from({0.9, -0.45, radians(1.1)}, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  add_noise(bev, 0.2F, 11);

  auto solver =
      make_solver(SolverKind::kDecoupled, kFeatureGrid, kChannels, hypotheses, parameters).value();
  SolverResult result;
  solver->solve(view(bev, kChannels, kFeatureGrid), view(map, kChannels, kFeatureGrid), result);

  const auto bev_planes = standardised(bev, kChannels);
  const auto map_planes = standardised(map, kChannels);
  std::vector<Plane> bev_signature;
  std::vector<Plane> map_signature;
  for (int c = 0; c < kChannels; ++c) {
    bev_signature.push_back(signature(bev_planes[c]));
    map_signature.push_back(signature(map_planes[c]));
  }
  const auto yaw = distribution(hypotheses.yaw_rad, parameters.yaw_scale, [&](double yaw_rad) {
    return yaw_score(bev_signature, map_signature, yaw_rad);
  });
  expect_near(result.yaw_probability, yaw);
  const double yaw_rad = mean(yaw, hypotheses.yaw_rad);

  Se2 expected_correction{0.0, 0.0, yaw_rad};
  for (const bool along_x : {true, false}) {
    std::vector<std::vector<double>> bev_axis;
    std::vector<std::vector<double>> map_axis;
    for (int c = 0; c < kChannels; ++c) {
      bev_axis.push_back(axis_features(bev_planes[c], yaw_rad, along_x));
      map_axis.push_back(axis_features(map_planes[c], 0.0, along_x));
    }
    const auto& axis = along_x ? hypotheses.x_m : hypotheses.y_m;
    const auto expected =
        distribution(axis, along_x ? parameters.x_scale : parameters.y_scale,
                     [&](double shift_m) { return axis_score(bev_axis, map_axis, shift_m); });
    expect_near(along_x ? result.x_probability : result.y_probability, expected);
    (along_x ? expected_correction.x_m : expected_correction.y_m) = mean(expected, axis);
  }
  EXPECT_THAT(result.correction, test::PoseNear(expected_correction, 1e-4, 1e-5));
}

}  // namespace
}  // namespace bevloc
