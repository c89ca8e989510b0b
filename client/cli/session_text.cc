#include "client/cli/session_text.h"

#include <google/protobuf/util/json_util.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "absl/time/time.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

// STATE_ACTIVE as "active".
std::string StateName(v1::Session::State state) {
  const std::string& name = v1::Session::State_Name(state);
  return absl::AsciiStrToLower(absl::StripPrefix(name, "STATE_"));
}

std::string TimeText(const google::protobuf::Timestamp& timestamp) {
  const absl::Time time = absl::FromUnixSeconds(timestamp.seconds());
  return absl::FormatTime("%Y-%m-%d %H:%M:%S UTC", time, absl::UTCTimeZone());
}

std::string GoalIds(const v1::Session& session) {
  return absl::StrJoin(session.goals(), ", ",
                       [](std::string* out, const v1::Goal& goal) {
                         absl::StrAppend(out, goal.goal_id());
                       });
}

}  // namespace

std::string SessionListText(const std::vector<v1::Session>& sessions) {
  Table table({{"NAME"},
               {"SKELETON"},
               {"STATE"},
               {"GOALS", Align::kRight},
               {"EXPIRES"}});
  for (const v1::Session& session : sessions) {
    table.AddRow(
        {session.name(), session.skeleton(), StateName(session.state()),
         absl::StrCat(session.goals_size()), TimeText(session.expire_time())});
  }
  return table.ToString();
}

std::string SessionText(const v1::Session& session) {
  Facts facts;
  facts.Add("name", session.name());
  facts.Add("skeleton", session.skeleton());
  facts.Add("state", StateName(session.state()));
  facts.Add("goals", GoalIds(session));
  facts.Add("created", TimeText(session.create_time()));
  facts.Add("expires", TimeText(session.expire_time()));
  facts.Add("pose", absl::StrJoin(session.pose().positions(), " ",
                                  [](std::string* out, double number) {
                                    absl::StrAppend(out, Fixed(number, 4));
                                  }));
  return facts.ToString();
}

Json SessionJson(const v1::Session& session) {
  std::string text;
  // Fails only for malformed times, which a server does not send.
  google::protobuf::util::MessageToJsonString(session, &text).ok();
  return Json::parse(text, nullptr, false);
}

Json SessionListJson(const std::vector<v1::Session>& sessions) {
  Json list = Json::array();
  for (const v1::Session& session : sessions) {
    list.push_back(SessionJson(session));
  }
  return {{"sessions", list}};
}

}  // namespace gelenk::cli
