#include "client/cli/skin/skin_list.h"

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/skin/served_skin.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

constexpr int kPageSize = 1000;

absl::StatusOr<std::vector<v1::Skin>> ListAll(client::Connection& connection) {
  std::vector<v1::Skin> skins;
  v1::ListSkinsRequest request;
  request.set_page_size(kPageSize);
  do {
    const absl::StatusOr<v1::ListSkinsResponse> page =
        connection.Call(&SkinStub::ListSkins, request);
    if (!page.ok()) return page.status();
    skins.insert(skins.end(), page->skins().begin(), page->skins().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return skins;
}

}  // namespace

absl::Status PrintSkins(client::Connection& connection, Format format,
                        std::string* output) {
  const auto skins = ListAll(connection);
  if (!skins.ok()) return skins.status();
  if (format == Format::kJson) {
    Json list = Json::array();
    for (const v1::Skin& skin : *skins) {
      list.push_back({{"name", skin.name()},
                      {"revision", skin.revision()},
                      {"skeleton", skin.skeleton()},
                      {"vertices", skin.vertex_count()},
                      {"bytes", skin.byte_size()},
                      {"display_name", skin.display_name()}});
    }
    *output += JsonText(list);
    return absl::OkStatus();
  }
  Table table({{"SKIN"},
               {"REVISION", Align::kRight},
               {"VERTICES", Align::kRight},
               {"MEMORY", Align::kRight},
               {"SKELETON"},
               {"TITLE"}});
  for (const v1::Skin& skin : *skins) {
    table.AddRow({skin.name(), absl::StrCat(skin.revision()),
                  absl::StrCat(skin.vertex_count()),
                  absl::StrCat(Fixed(skin.byte_size() / 1e6, 1), " MB"),
                  skin.skeleton(), skin.display_name()});
  }
  *output += table.ToString();
  return absl::OkStatus();
}

absl::Status DeleteSkin(client::Connection& connection,
                        const std::string& name) {
  if (!absl::StartsWith(name, "skins/")) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", name, "\": want skins/NAME"));
  }
  v1::DeleteSkinRequest request;
  request.set_name(name);
  return connection.Call(&SkinStub::DeleteSkin, request).status();
}

}  // namespace gelenk::cli
