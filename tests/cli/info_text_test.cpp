// What `tessera info` says of materials by their model, and of names that would steer a terminal.
#include "cli/run_command.h"

#include <simdjson.h>

namespace {

using InfoText = CliTest;

TEST_F(InfoText, NamesAreTakenOffWhatSteersATerminal) {
    // Right-to-left override, an isolate, a control of C1, bytes that are no UTF-8, and what may stay.
    std::ofstream(in_folder("a.obj"), std::ios::binary) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\xe2\x80\xae"
                                                           "b\xe2\x81\xa6"
                                                           "c\xc2\x9b"
                                                           "d\xff"
                                                           "e\xc0\xaf"
                                                           "f\xc3\xa9\xe2\x82\xac\nf 1 2 3\n";
    const Outcome run = run_command({"info", in_folder("a.obj")});
    ASSERT_EQ(run.code, 0) << run.err;
    const std::string clean =
        "\"a b c d\xef\xbf\xbd"
        "e\xef\xbf\xbd\xef\xbf\xbd"
        "f\xc3\xa9\xe2\x82\xac\" is not defined";
    EXPECT_NE((run.out + run.err).find(clean), std::string::npos) << run.out << run.err;
    for (const char* bad : {"\xe2\x80\xae", "\xe2\x81\xa6", "\xc2\x9b", "\xff"})
        EXPECT_EQ((run.out + run.err).find(bad), std::string::npos);
}

TEST_F(InfoText, MaterialsShowWhatTheirModelHas) {
    std::ofstream(in_folder("m.gltf"))
        << R"({"asset":{"version":"2.0"},"materials":[{},{"extensions":{"KHR_materials_unlit":{}}},)"
        << R"({"extensions":{"TESSERA_materials_phong":{"model":"lambert","ambient":[0.25,0,0],"diffuse":[0.5,1,2]}}},)"
        << R"({"extensions":{"TESSERA_materials_phong":{"specular":[0.5,0,1],"shininess":80}}},)"
        << R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"glossinessFactor":0.75}}}]})";
    const Outcome run = run_command({"info", in_folder("m.gltf"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parser.parse(run.out), materials = json["materials"];
    const char* const parts[5][3] = {{"specular", "textbook", "specular_glossiness"},
                                     {nullptr, "specular", "textbook"},
                                     {"textbook", "specular", "specular_glossiness"},
                                     {"textbook", "specular", "specular_glossiness"},
                                     {"specular_glossiness", "specular", "textbook"}};
    for (std::size_t i = 0; i < 5; ++i) {
        if (parts[i][0]) {
            EXPECT_EQ(materials.at(i)[parts[i][0]].error(), simdjson::SUCCESS) << i;
        }
        for (std::size_t k = 1; k < 3; ++k) EXPECT_NE(materials.at(i)[parts[i][k]].error(), simdjson::SUCCESS) << i;
    }
    EXPECT_EQ(double(materials.at(2)["textbook"]["ambient"].at(0)), 0.25);
    EXPECT_EQ(double(materials.at(2)["textbook"]["diffuse"].at(2)), 2);
    EXPECT_EQ(double(materials.at(3)["textbook"]["specular"].at(0)), 0.5);
    EXPECT_EQ(double(materials.at(3)["textbook"]["shininess"]), 80);
    EXPECT_EQ(double(materials.at(4)["specular_glossiness"]["glossiness"]), 0.75);
}

}  // namespace
