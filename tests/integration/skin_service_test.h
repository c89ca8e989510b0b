// A real gelenkd and the skin calls to it.
#ifndef GELENK_TESTS_INTEGRATION_SKIN_SERVICE_TEST_H_
#define GELENK_TESTS_INTEGRATION_SKIN_SERVICE_TEST_H_

#include <gtest/gtest.h>

#include <string>

#include "convert/skin_surface.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/v1/skin_service.grpc.pb.h"
#include "tests/integration/service_test.h"

namespace gelenk {

class SkinServiceTest : public ServiceTest {
 protected:
  using Stub = v1::SkinService::Stub;

  static Stub& skins() { return connection().stub<Stub>(); }

  // Bounds a call in time.
  static void Prepare(grpc::ClientContext& context) {
    client::CallOptions options;
    options.timeout = testing::kPatience;
    connection().Prepare(options, context);
  }

  // A tube along the planar arm, whose links are of 0.5 m.
  static TriangleMesh Tube() { return TubeMesh({1.5, 0.08, 60, 16}).value(); }
  static v1::CreateSkinRequest TubeRequest(const std::string& id = "") {
    v1::CreateSkinRequest request;
    request.set_skin_id(id);
    request.mutable_skin()->set_skeleton("skeletons/planar-arm");
    convert::ToProto(Tube(), request.mutable_skin()->mutable_mesh());
    return request;
  }

  static v1::Skin Create(const v1::CreateSkinRequest& request) {
    const auto skin = Call(&Stub::CreateSkin, request);
    EXPECT_EQ(skin.status(), absl::OkStatus());
    return skin.value_or(v1::Skin());
  }
};

}  // namespace gelenk

#endif  // GELENK_TESTS_INTEGRATION_SKIN_SERVICE_TEST_H_
